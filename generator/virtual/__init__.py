"""Virtual encoders that behave like the encoder of an order code over RS-485, BiSS, SSI and SPI, with faults on demand.

They use only the model and the reference codec, so they can also check generated code.
"""

from .clocked_lines import BissLine as BissLine
from .clocked_lines import SsiLine as SsiLine
from .encoder import VirtualEncoder as VirtualEncoder
from .rs485_line import Rs485Line as Rs485Line
from .simulation_options import FAULTS as FAULTS
from .simulation_options import Faults as Faults
from .simulation_options import faults_of as faults_of
from .simulation_options import motion as motion
from .spi_line import SpiLine as SpiLine
