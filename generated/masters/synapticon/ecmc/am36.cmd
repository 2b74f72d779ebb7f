#- SOMANET Circulo with the order codes of AM36 and AMC36 absolute multiturn encoders. For ecmc, as commands for the
#-   slave ECMC_EC_SLAVE_NUM.
#- From the spec of AM36 and AMC36 absolute multiturn encoders, manual AM36 AMC36, revision 1.0.
#- From the documents of the master: p834: SOMANET Circulo 7, documentation v4.19.0, p. 834; p835: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 835; p846: SOMANET Circulo 7, documentation v4.19.0, p. 846; p833: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 833.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === AM3616/4096-BG, AMC3616/4096-BG
#- #- Not in this file: Frame size = 28: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,12,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,16,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,12,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AM3616/4096-GG, AMC3616/4096-GG
#- #- Not in this file: Frame size = 28: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,12,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,16,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,12,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === AM3619/4096-BG, AMC3619/4096-BG
#- #- Not in this file: Frame size = 31: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,12,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,19,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,12,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AM3619/4096-GG, AMC3619/4096-GG
#- #- Not in this file: Frame size = 31: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,12,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,19,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,12,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === AM3616/4096-I7, AM3619/4096-I7, AMC3616/4096-I7, AMC3619/4096-I7
#- #- Not in this file: Frame size = 36: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,16,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,16,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,10,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"
