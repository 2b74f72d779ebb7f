"""Rules for the numbers of contacts."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from ...model import Connector
from ..problems import DocumentReport, quoted
from ..schema_files import is_second
from ..written import Located
from ..written_parts import WrittenSpec

#: The index in the list and the number of each contact with a number.
Numbered = Sequence[tuple[int, int]]


def check_contact_numbers(spec: WrittenSpec, as_read: WrittenSpec, report: DocumentReport) -> None:
    """Check that contacts are numbered consecutively from 1, unless a note explains why not.

    A cable whose wires all have numbers is likely a connector, unless its note says that they are numbered.
    """
    if is_second(report.document.file) or report.document.family:  # The note belongs to the newest edition.
        return
    for connector in spec.connectors:
        names = [contact.contact for contact in connector.part.contacts]
        # With their index, because contacts such as the case have names.
        numbered_contacts = [(index, int(name)) for index, name in enumerate(names) if name.isdecimal()]
        if not numbered_contacts:
            continue
        is_numbered_cable = connector.part.kind == "cable" and len(numbered_contacts) == len(names)
        if is_numbered_cable and "number" not in connector.part.note:
            message = (
                f"all wires of {quoted(connector.part.name)} have numbers, as the contacts of a connector; write 'kind:"
                " connector', or say in a 'note' that the wires are numbered"
            )
            report.add("contact-numbers", (*connector.path, "kind"), message)
        _check_order(connector, numbered_contacts, report)


def _check_order(connector: Located[Connector], numbered: Numbered, report: DocumentReport) -> None:
    """Report the first contact whose number does not follow the number of the contact before it, or has a leading zero.

    The number may repeat. A note that contains the expected number explains a gap.
    """
    # The first contact is compared with an imaginary one that has the number 0.
    for (_, earlier_number), (index, number) in pairwise([(-1, 0), *numbered]):
        expected_number = earlier_number + 1
        is_explained = re.search(rf"\b{expected_number}\b", connector.part.note) is not None
        # One contact can have several signals, for different order codes.
        is_repeated = number == earlier_number > 0
        is_next = number == expected_number or is_repeated
        has_leading_zero = connector.part.contacts[index].contact != str(number)
        if has_leading_zero or not (is_next or is_explained):
            message = (
                f"contact {quoted(connector.part.contacts[index].contact)} is where {quoted(str(expected_number))}"
                " should be; list all contacts in order, including unconnected contacts, or say in a 'note' of"
                f" {quoted(connector.part.name)} that there is no contact {expected_number}"
            )
            report.add("contact-numbers", (*connector.path, "contacts", index, "contact"), message)
            return
