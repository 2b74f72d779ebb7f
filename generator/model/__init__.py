"""The model: one encoder family, fully resolved, as frozen data.

Everything that can be worked out is worked out here or on the way here: positions, widths, masks, CRC plans, order codes.
A target reads the model and computes no bit position. Bit 0 is the least significant bit everywhere, and a number of several
bytes is one integer whose byte order the layout states.
"""

from .device import (
    Argument as Argument,
    CodePart as CodePart,
    CodeValue as CodeValue,
    ControlField as ControlField,
    Device as Device,
    Example as Example,
    FieldGroup as FieldGroup,
    Interface as Interface,
    Measurement as Measurement,
    OrderCode as OrderCode,
    Parameter as Parameter,
    Procedure as Procedure,
    Register as Register,
    RegisterMeaning as RegisterMeaning,
    SpelledValue as SpelledValue,
    Spelling as Spelling,
    Step as Step,
    Variant as Variant,
    Write as Write,
)
from .facts import (
    Alarm as Alarm,
    CableLength as CableLength,
    Characteristic as Characteristic,
    Connector as Connector,
    Contact as Contact,
    Document as Document,
    Edition as Edition,
    Erratum as Erratum,
    Input as Input,
    Led as Led,
    LedState as LedState,
    LostFigure as LostFigure,
    Manual as Manual,
    Manufacturer as Manufacturer,
    MemoryAccess as MemoryAccess,
    Network as Network,
    Port as Port,
    PrintedTimeout as PrintedTimeout,
    Revision as Revision,
    Source as Source,
    Sources as Sources,
    Supply as Supply,
    Table as Table,
    Timeout as Timeout,
    Timing as Timing,
    cite as cite,
)
from .layout import (
    Crc as Crc,
    DataId as DataId,
    Digits as Digits,
    Field as Field,
    FoldStep as FoldStep,
    Join as Join,
    Layout as Layout,
    Piece as Piece,
    PlacedField as PlacedField,
    PlacedLayout as PlacedLayout,
    Value as Value,
)
