#- EJ5042 with the order codes of AM36 and AMC36 absolute multiturn encoders. For ecmc, as commands for the slave
#-   ECMC_EC_SLAVE_NUM.
#- From the spec of AM36 and AMC36 absolute multiturn encoders, manual AM36 AMC36, revision 1.0.
#- From the documents of the master: ej5042: EJ5042 configuration data.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Write Disable Status Bits and CRC Polynomial after Mode. * [ssi: Mode sets both, ep7041_biss: steps 2 and 3,
#-   ep7041_ssi: steps 2 and 3]
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === AM3616/4096-BG, AMC3616/4096-BG
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,8)"
#- #- Clock Frequency, EJ5042
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,17,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,12,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,16,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AM3616/4096-GG, AMC3616/4096-GG
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,8)"
#- #- Clock Frequency, EJ5042
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,17,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,12,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,16,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AM3619/4096-BG, AMC3619/4096-BG
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,8)"
#- #- Clock Frequency, EJ5042
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,17,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,12,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,19,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AM3619/4096-GG, AMC3619/4096-GG
#-
#-
#- #- channel 1
#- #- Mode
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x18,1,1)"
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,0,8)"
#- #- Clock Frequency, EJ5042
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,17,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,1,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,12,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,19,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"

#- === AM3616/4096-I7, AM3619/4096-I7, AMC3616/4096-I7, AMC3619/4096-I7
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,8)"
#- #- Clock Frequency, EJ5042
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,16,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"
#- #- Offset LSB Bit [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x17,0,1)"
