"""Decode a frame with nothing but a device's XML: decode_from_xml.py generated/biss/lika-amm5.xml AMM5A21/65KSC1 single_cycle_data 0xF4243D3"""
import re
import sys
from lxml import etree

if len(sys.argv) != 5:
    sys.exit(__doc__)
path, code, name, frame = sys.argv[1:]
ns = {"d": "urn:codewheel:device-description:1"}
root = etree.parse(path, etree.XMLParser(resolve_entities=False, no_network=True))
order_code = root.xpath("//d:order_code[@code=$code]", namespaces=ns, code=code)[0]
parameters = {entry.get("name"): int(entry.text, 0) for entry in order_code.iterfind("d:parameters/d:entry", ns)}

def number(expression):  # a sum of numbers and parameters, such as 48 - singleturn_bits
    terms = re.findall(r"([+-]?) ?([a-z0-9_]+)", expression)
    return sum((-1 if sign == "-" else 1) * int(parameters.get(term, term)) for sign, term in terms)

layout = root.xpath("//d:layouts/d:layout[@name=$name]", namespaces=ns, name=name)[0]
first_is_low = layout.get("byte_order") == "low_byte_first"
bits = int.from_bytes(bytes.fromhex(frame), "little" if first_is_low else "big") if layout.get("carried_as") == "bytes" else int(frame, 0)
for field in layout.iterfind("d:fields/d:field", ns):
    value = bits >> number(field.get("low")) & (1 << number(field.get("width"))) - 1
    state = ["active" if value == (field.get("active") == "high") else "not active"] if field.get("active") else []
    print(field.get("name"), value, *state)
if layout.get("gray_of") and parameters.get(layout.get("gray_when"), 1):
    print("note:", layout.get("gray_of"), "is in Gray code; its bits are shown as they are sent")
