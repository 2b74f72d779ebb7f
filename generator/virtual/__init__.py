"""Virtual encoders that behave like the encoder of an order code over RS-485, BiSS, SSI and SPI, with faults on demand.

They use only the model and the reference codec, so they can also check generated code.
"""

from .clocked_lines import BissLine as BissLine
from .clocked_lines import SsiLine as SsiLine
from .encoder import VirtualEncoder as VirtualEncoder
from .faults import FAULTS as FAULTS
from .faults import Faults as Faults
from .faults import faults_of as faults_of
from .faults import motion as motion
from .rs485_line import Rs485Line as Rs485Line
from .spi_line import SpiLine as SpiLine
