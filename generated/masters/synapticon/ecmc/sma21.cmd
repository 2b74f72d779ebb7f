#- SOMANET Circulo with the order codes of SMA21 absolute linear encoder. For ecmc, as commands for the slave
#-   ECMC_EC_SLAVE_NUM.
#- From the spec of SMA21 absolute linear encoder, manual SMA21 + MTA-A154, revision 1.2.
#- From the documents of the master: p834: SOMANET Circulo 7, documentation v4.19.0, p. 834; p835: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 835; p846: SOMANET Circulo 7, documentation v4.19.0, p. 846; p833: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 833.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === SMA21-BG1-0050, SMA21-BG4-0050
#- #- Not in this file: Frame size = 21: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === SMA21-BG1-0010, SMA21-BG4-0010
#- #- Not in this file: Frame size = 23: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,22,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === SMA21-BG1-0005, SMA21-BG4-0005
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,23,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === SMA21-BG1-0002, SMA21-BG4-0002
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,24,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === SMA21-BG1-0001, SMA21-BG4-0001
#- #- Not in this file: Frame size = 26: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,25,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === SMA21-GG1-0050, SMA21-G11-0050, SMA21-GG4-0050, SMA21-G14-0050
#- #- Not in this file: Frame size = 21: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === SMA21-GG1-0010, SMA21-G11-0010, SMA21-GG4-0010, SMA21-G14-0010
#- #- Not in this file: Frame size = 23: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,22,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === SMA21-GG1-0005, SMA21-G11-0005, SMA21-GG4-0005, SMA21-G14-0005
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,23,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === SMA21-GG1-0002, SMA21-G11-0002, SMA21-GG4-0002, SMA21-G14-0002
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,24,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === SMA21-GG1-0001, SMA21-G11-0001, SMA21-GG4-0001, SMA21-G14-0001
#- #- Not in this file: Frame size = 26: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,25,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === SMA21-SC1-0050, SMA21-SC4-0050
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,4,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === SMA21-SC1-0010, SMA21-SC4-0010
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,22,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,2,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === SMA21-SC1-0005, SMA21-SC4-0005
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,23,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,1,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === SMA21-SC1-0002, SMA21-SC4-0002
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,24,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === SMA21-SC1-0001, SMA21-SC4-0001
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,25,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,16,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"
