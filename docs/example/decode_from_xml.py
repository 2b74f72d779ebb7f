"""Decode a frame with only a device's XML.

decode_from_xml.py generated/biss/lika-amm5.xml AMM5A21/65KSC1 single_cycle_data 0xF4243D3
"""

import re
import sys

from lxml import etree

if len(sys.argv) < 5:
    sys.exit(__doc__)
path, code, name, frame, *answers = sys.argv[1:]
ns = {"d": "urn:codewheel:device-description:1"}
root = etree.parse(path, etree.XMLParser(resolve_entities=False, no_network=True))
order_code = root.xpath("//d:order_code[@code=$code]", namespaces=ns, code=code)[0]
parameters = {entry.get("name"): int(entry.text, 0) for entry in order_code.iterfind("d:parameters/d:entry", ns)}


def number(expression):  # a sum of numbers and parameters, such as 48 - singleturn_bits
    terms = re.findall(r"([+-]?) ?([a-z0-9_*^]+)", expression)
    return sum((-1 if sign == "-" else 1) * int(parameters.get(term, term)) for sign, term in terms)


layout = root.xpath("//d:layouts/d:layout[@name=$name]", namespaces=ns, name=name)[0]
for asked in layout.get("alternatives", "").split():
    known = root.xpath(f"//d:alternative[@name='{asked}']/d:answers/d:answer", namespaces=ns)
    chosen = next((item for item in known if f"{asked}={item.get('name')}" in answers), None)
    if chosen is None:
        sys.exit(f"choose: {' or '.join(f'{asked}=' + item.get('name') for item in known)}")
    parameters |= {entry.get("name"): int(entry.text, 0) for entry in chosen.iterfind("d:sets/d:entry", ns)}
order = "little" if layout.get("byte_order") == "low_byte_first" else "big"
bits = int.from_bytes(bytes.fromhex(frame), order) if layout.get("carried_as") == "bytes" else int(frame, 0)
fields = layout.findall("d:fields/d:field", ns)
for field in [field for field in fields if not number(field.get("width"))]:
    field.getparent().remove(field)  # The order code does not have it, and no verdict depends on it.
speaks, found = {}, set()
for field in layout.iterfind("d:fields/d:field", ns):
    value = bits >> number(field.get("low")) & (1 << number(field.get("width"))) - 1
    if field.get("byte_order"):  # not that of the layout
        value = int.from_bytes(value.to_bytes(number(field.get("width")) // 8, "little"), "big")
    said = "not as in the manual" if value != int(field.get("unused", value)) else ""
    if field.get("active"):  # a flag
        said = "active" if value == (field.get("active") == "high") else "not active"
        found.add(f"{field.get('name')}.{said.replace('not ', 'in')}")
    if said not in ("", "not active"):
        speaks[field.get("name")] = field
    for named in field.iterfind("d:values/d:value", ns):
        if value == int(named.get("value"), 0):
            found.add(f"{field.get('name')}.{named.get('name')}")
            speaks |= {(field.get("name"), value): named} if named.get("makes_position") else {}
    print(f"{field.get('name')} {value} {said}".rstrip())
combinations = layout.findall("d:combinations/d:combination", ns)
speaks |= {item.get("name"): item for item in combinations if {*item.get("when").split()} <= found}
if layout.get("gray_of") and parameters.get(layout.get("gray_when"), 1):
    print("note:", layout.get("gray_of"), "is in Gray code. Its bits are shown as they are sent")


def makes(field):  # The manual does not explain a flag for order codes with the parameter only_while at 0.
    return field.get("makes_position") if parameters.get(field.get("only_while"), 1) else "usable_with_warning"


# The most severe verdict decides. A flag that sums up others is silent while one of these is active.
worth = {makes(item) for item in speaks.values() if not {*item.get("sums_up", "").split()} & {*speaks}}
flags = "d:fields/d:field[@kind='flag' and not(@makes_position='usable') and not(string(@only_while))]"
values = "d:fields/d:field/d:values/d:value[string(@makes_position) and not(@makes_position='usable')]"
worth.add("usable" if combinations or layout.xpath(f"{flags} | {values}", namespaces=ns) else "unknown")
position = {*root.xpath("//d:measurement/@of", namespaces=ns)}
joins = root.xpath("//d:layout[@interface=$kind]/d:join/d:join", namespaces=ns, kind=layout.get("interface"))
position |= {part for join in joins if join.get("name") in position for part in join.get("fields").split()}
if layout.get("from") == "encoder" and position & {field.get("name") for field in fields}:
    print("verdict:", min(worth, key=["not_usable", "unknown", "usable_with_warning", "usable"].index))
