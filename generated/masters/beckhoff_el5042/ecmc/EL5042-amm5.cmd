#- EL5042 with the order codes of AMM5A and AMM5B absolute kit encoders. For ecmc, as commands for the slave
#-   ECMC_EC_SLAVE_NUM.
#- From the spec of AMM5A and AMM5B absolute kit encoders, manual AMM5A AMM5B, revision 1.9.
#- From the documents of the master: objects: EL5042 configuration data; ej5042: EJ5042 configuration data; supply:
#-   EL5042 setting the encoder supply voltage; psi: paulscherrerinstitute/ecmccfg,
#-   hardware/Encoders/ecmcEL5042-Encoder-RLS-LA11-24bit.cmd.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master/master-files.md. Form of the file: ecmc.
#- Before writing Supply Voltage, F008 (Code word) must be 0x72657375. [supply]
#- Supply Voltage takes effect only in the INIT state. [supply]
#- Write Disable Status Bits and CRC Polynomial after Mode. * [ssi: Mode sets both, ep7041_biss: steps 2 and 3,
#-   ep7041_ssi: steps 2 and 3]
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === AMM5A17/1BG1, AMM5B17/1BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,17,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AMM5A17/65KBG1, AMM5B17/65KBG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,16,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,17,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AMM5A21/1BG1, AMM5B21/1BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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

#- === AMM5A21/65KBG1, AMM5B21/65KBG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,16,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AMM5A23/1BG1, AMM5B23/1BG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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

#- === AMM5A23/65KBG1, AMM5B23/65KBG1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,16,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AMM5A17/1SC1, AMM5B17/1SC1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,17,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AMM5A17/65KSC1, AMM5B17/65KSC1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,16,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,17,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AMM5A21/1SC1, AMM5B21/1SC1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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

#- === AMM5A21/65KSC1, AMM5B21/65KSC1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,16,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,21,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AMM5A23/1SC1, AMM5B23/1SC1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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

#- === AMM5A23/65KSC1, AMM5B23/65KSC1
#- #- Not in this file: Supply Voltage: 50 is the factory default. Write it only if the setting was changed.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,16,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"
