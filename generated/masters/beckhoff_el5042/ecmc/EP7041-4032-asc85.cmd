#- EP7041-4032 with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For ecmc, as commands for
#-   the slave ECMC_EC_SLAVE_NUM.
#- From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
#- From the documents of the master: ep7041_objects: EP7041-4032 configuration objects.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Write Disable Status Bits and CRC Polynomial after Mode. * [ssi: Mode sets both, ep7041_biss: steps 2 and 3,
#-   ep7041_ssi: steps 2 and 3]
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === ASC8520/BG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8520/BG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8520/GG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8520/GG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8521/BG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8521/BG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8521/GG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8521/GG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8522/BG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8522/BG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8522/GG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8522/GG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8523/BG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8523/BG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8523/GG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8523/GG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8524/BG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8524/BG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8524/GG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8524/GG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8525/BG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === ASC8525/BG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === ASC8525/GG1
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === ASC8525/GG2
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,4,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === ASC8520/SC1 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8520/SC1 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8520/SC2 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8520/SC2 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === ASC8521/SC1 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8521/SC1 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8521/SC2 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8521/SC2 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"

#- === ASC8522/SC1 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8522/SC1 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8522/SC2 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8522/SC2 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === ASC8523/SC1 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8523/SC1 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8523/SC2 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8523/SC2 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === ASC8524/SC1 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8524/SC1 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8524/SC2 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8524/SC2 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === ASC8525/SC1 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === ASC8525/SC1 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === ASC8525/SC2 with zero_bit=as_printed
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === ASC8525/SC2 with zero_bit=left_out
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"
