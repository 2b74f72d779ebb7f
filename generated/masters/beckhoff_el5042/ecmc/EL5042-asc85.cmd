#- EL5042 with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For ecmc, as commands for the
#-   slave ECMC_EC_SLAVE_NUM.
#- From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
#- From the documents of the master: objects: EL5042 configuration data; ej5042: EJ5042 configuration data; psi:
#-   paulscherrerinstitute/ecmccfg, hardware/Encoders/ecmcEL5042-Encoder-RLS-LA11-24bit.cmd.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Write Disable Status Bits and CRC Polynomial after Mode. * [ssi: Mode sets both, ep7041_biss: steps 2 and 3,
#-   ep7041_ssi: steps 2 and 3]
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === ASC8520/BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8520/BG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8520/GG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8520/GG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8521/BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8521/BG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8521/GG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8521/GG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8522/BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8522/BG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8522/GG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8522/GG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8523/BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8523/BG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8523/GG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8523/GG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8524/BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8524/BG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8524/GG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8524/GG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8525/BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8525/BG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8525/GG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8525/GG2
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8520/SC1 with zero_bit=as_printed
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8520/SC1 with zero_bit=left_out
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8520/SC2 with zero_bit=as_printed
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8520/SC2 with zero_bit=left_out
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8521/SC1 with zero_bit=as_printed
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8521/SC1 with zero_bit=left_out
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8521/SC2 with zero_bit=as_printed
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8521/SC2 with zero_bit=left_out
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8522/SC1 with zero_bit=as_printed
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8522/SC1 with zero_bit=left_out
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8522/SC2 with zero_bit=as_printed
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8522/SC2 with zero_bit=left_out
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8523/SC1 with zero_bit=as_printed
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8523/SC1 with zero_bit=left_out
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8523/SC2 with zero_bit=as_printed
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8523/SC2 with zero_bit=left_out
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8524/SC1 with zero_bit=as_printed
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8524/SC1 with zero_bit=left_out
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8524/SC2 with zero_bit=as_printed
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8524/SC2 with zero_bit=left_out
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8525/SC1 with zero_bit=as_printed
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8525/SC1 with zero_bit=left_out
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === ASC8525/SC2 with zero_bit=as_printed
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,1,1)"

#- === ASC8525/SC2 with zero_bit=left_out
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,0,1)"
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
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"
