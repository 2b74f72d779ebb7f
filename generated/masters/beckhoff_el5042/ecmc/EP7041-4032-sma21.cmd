#- EP7041-4032 with the order codes of SMA21 absolute linear encoder. For ecmc, as commands for the slave
#-   ECMC_EC_SLAVE_NUM.
#- From the spec of SMA21 absolute linear encoder, manual SMA21 + MTA-A154, revision 1.2.
#- From the documents of the master: ep7041_objects: EP7041-4032 configuration objects.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Before writing Supply Voltage, F008 (Code word) must be 0x72657375. [supply]
#- Supply Voltage takes effect only in the INIT state. [supply]
#- Write Disable Status Bits and CRC Polynomial after Mode. * [ssi: Mode sets both, ep7041_biss: steps 2 and 3,
#-   ep7041_ssi: steps 2 and 3]
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === SMA21-BG1-0050, SMA21-BG4-0050
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === SMA21-BG1-0010, SMA21-BG4-0010
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === SMA21-BG1-0005, SMA21-BG4-0005
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === SMA21-BG1-0002, SMA21-BG4-0002
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === SMA21-BG1-0001, SMA21-BG4-0001
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === SMA21-GG1-0050, SMA21-G11-0050, SMA21-GG4-0050, SMA21-G14-0050
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === SMA21-GG1-0010, SMA21-G11-0010, SMA21-GG4-0010, SMA21-G14-0010
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,22,1)"

#- === SMA21-GG1-0005, SMA21-G11-0005, SMA21-GG4-0005, SMA21-G14-0005
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,23,1)"

#- === SMA21-GG1-0002, SMA21-G11-0002, SMA21-GG4-0002, SMA21-G14-0002
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === SMA21-GG1-0001, SMA21-G11-0001, SMA21-GG4-0001, SMA21-G14-0001
#- #- Not in this file: Mode = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Supply Voltage: 50 is the factory default. Leave it unless it was changed.
#- #- Not in this file: Offset LSB Bit [Bit] = 1: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,9,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,25,1)"

#- === SMA21-SC1-0050, SMA21-SC1-0010, SMA21-SC1-0005, SMA21-SC1-0002, SMA21-SC4-0050, SMA21-SC4-0010, SMA21-SC4-0005,
#-   SMA21-SC4-0002
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

#- === SMA21-SC1-0001, SMA21-SC4-0001
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
