#- SOMANET Circulo with the order codes of AMM5A and AMM5B absolute kit encoders. For ecmc, as commands for the slave
#-   ECMC_EC_SLAVE_NUM.
#- From the spec of AMM5A and AMM5B absolute kit encoders, manual AMM5A AMM5B, revision 1.9.
#- From the documents of the master: p834: SOMANET Circulo 7, documentation v4.19.0, p. 834; p835: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 835; p836: SOMANET Circulo 7, documentation v4.19.0, p. 836; p846: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 846; p833: SOMANET Circulo 7, documentation v4.19.0, p. 833.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === AMM5A17/1BG1, AMM5B17/1BG1
#- #- Not in this file: Frame size = 17: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,17,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AMM5A17/65KBG1, AMM5B17/65KBG1
#- #- Not in this file: Frame size = 33: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,16,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,17,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,16,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AMM5A21/1BG1, AMM5B21/1BG1
#- #- Not in this file: Frame size = 21: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,21,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AMM5A21/65KBG1, AMM5B21/65KBG1
#- #- Not in this file: Frame size = 37: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,16,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,21,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,16,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AMM5A23/1BG1, AMM5B23/1BG1
#- #- Not in this file: Frame size = 23: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,23,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AMM5A23/65KBG1, AMM5B23/65KBG1
#- #- Not in this file: Frame size = 39: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,16,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,23,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,16,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === AMM5A17/1SC1, AMM5B17/1SC1
#- #- Not in this file: Frame size = 17: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,17,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,30,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === AMM5A17/65KSC1, AMM5B17/65KSC1
#- #- Not in this file: Frame size = 33: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,16,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,17,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,16,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,30,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === AMM5A21/1SC1, AMM5B21/1SC1
#- #- Not in this file: Frame size = 21: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,21,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,30,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === AMM5A21/65KSC1, AMM5B21/65KSC1
#- #- Not in this file: Frame size = 37: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,16,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,21,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,16,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,30,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === AMM5A23/1SC1, AMM5B23/1SC1
#- #- Not in this file: Frame size = 23: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,23,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,30,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === AMM5A23/65KSC1, AMM5B23/65KSC1
#- #- Not in this file: Frame size = 39: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,16,1)"
#- #- Multiturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xB,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,23,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,16,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,30,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"
