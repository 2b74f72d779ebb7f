#- AX8000 with the order codes of SMA21 absolute linear encoder. For ecmc, as commands for the slave ECMC_EC_SLAVE_NUM.
#- From the spec of SMA21 absolute linear encoder, manual SMA21 + MTA-A154, revision 1.2.
#- From the documents of the master: linear: AX8xxx object 32EF BiSS-C encoder parameter (linear); linear_bits: AX8xxx
#-   object 32EF:05 position bit count, linear; linear_layout: AX8xxx object 32EF:06 data layout, linear; power: AX8xxx
#-   object 32EF:02 power supply; linear_step: AX8xxx object 32EF:03 measuring step length; linear_fill: AX8xxx object
#-   32EF:08 fill bit count right, linear; linear_clock: AX8xxx object 32EF:0A max encoder clock frequency, linear;
#-   linear_crc: AX8xxx object 32EF:0D CRC polynome, linear; linear_inverted: AX8xxx object 32EF:0E CRC data inverted,
#-   linear.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === SMA21-SC1-0050, SMA21-SC4-0050
#- #- Derived, not stated in a document: CRC polynome.
#- #- Not in this file: Fill bit count left = 4: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring step length
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,50000000,8)"
#- #- Position bit count
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,20,1)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Fill bit count right
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x8,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xA,10000,2)"
#- #- CRC polynome, derived
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,67,1)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xE,1,1)"

#- === SMA21-SC1-0010, SMA21-SC4-0010
#- #- Derived, not stated in a document: CRC polynome.
#- #- Not in this file: Fill bit count left = 2: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring step length
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,10000000,8)"
#- #- Position bit count
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,22,1)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Fill bit count right
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x8,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xA,10000,2)"
#- #- CRC polynome, derived
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,67,1)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xE,1,1)"

#- === SMA21-SC1-0005, SMA21-SC4-0005
#- #- Derived, not stated in a document: CRC polynome.
#- #- Not in this file: Fill bit count left = 1: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring step length
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,5000000,8)"
#- #- Position bit count
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,23,1)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Fill bit count right
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x8,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xA,10000,2)"
#- #- CRC polynome, derived
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,67,1)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xE,1,1)"

#- === SMA21-SC1-0002, SMA21-SC4-0002
#- #- Derived, not stated in a document: CRC polynome.
#- #- Not in this file: Fill bit count left = 0: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring step length
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,2000000,8)"
#- #- Position bit count
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,24,1)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Fill bit count right
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x8,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xA,10000,2)"
#- #- CRC polynome, derived
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,67,1)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xE,1,1)"

#- === SMA21-SC1-0001, SMA21-SC4-0001
#- #- Derived, not stated in a document: CRC polynome.
#- #- Not in this file: Fill bit count left = 0: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring step length
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,1000000,8)"
#- #- Position bit count
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,25,1)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Fill bit count right
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x8,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xA,10000,2)"
#- #- CRC polynome, derived
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,67,1)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xE,1,1)"
