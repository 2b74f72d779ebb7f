#- SOMANET Circulo with the order codes of iC-MU and iC-MU150 magnetic off-axis encoder chips. For ecmc, as commands for
#-   the slave ECMC_EC_SLAVE_NUM.
#- From the spec of iC-MU and iC-MU150 magnetic off-axis encoder chips, manual iC-MU magnetic off-axis position encoder
#-   - pole width 1.28 mm, revision D1.
#- From the documents of the master: p834: SOMANET Circulo 7, documentation v4.19.0, p. 834; p835: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 835; p846: SOMANET Circulo 7, documentation v4.19.0, p. 846; p833: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 833.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === iC-MU-16-0, iC-MU150-16-0
#- #- Not in this file: Frame size = 16: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,16,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-16-2, iC-MU150-16-2
#- #- Not in this file: Frame size = 18: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,16,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-16-7, iC-MU150-16-7
#- #- Not in this file: Frame size = 23: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,16,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-18-0, iC-MU150-18-0
#- #- Not in this file: Frame size = 18: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,18,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-18-2, iC-MU150-18-2
#- #- Not in this file: Frame size = 20: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,18,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-18-7, iC-MU150-18-7
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,18,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-19-0, iC-MU150-19-0
#- #- Not in this file: Frame size = 19: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,19,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-19-2, iC-MU150-19-2
#- #- Not in this file: Frame size = 21: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,19,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-19-7, iC-MU150-19-7
#- #- Not in this file: Frame size = 26: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,19,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-20-0, iC-MU150-20-0
#- #- Not in this file: Frame size = 20: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-20-2, iC-MU150-20-2
#- #- Not in this file: Frame size = 22: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-20-7, iC-MU150-20-7
#- #- Not in this file: Frame size = 27: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-24-0, iC-MU150-24-0
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-24-2, iC-MU150-24-2
#- #- Not in this file: Frame size = 26: not given: index, subindex and a width in whole bytes.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-24-7, iC-MU150-24-7
#- #- Not in this file: Frame size = 31: not given: index, subindex and a width in whole bytes.
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-28-0, iC-MU150-28-0
#- #- Not in this file: Frame size = 28: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,28,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-28-2, iC-MU150-28-2
#- #- Not in this file: Frame size = 30: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,28,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-28-7, iC-MU150-28-7
#- #- Not in this file: Frame size = 35: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,28,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-38-0, iC-MU150-38-0
#- #- Not in this file: Frame size = 38: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,38,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-38-2, iC-MU150-38-2
#- #- Not in this file: Frame size = 40: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,38,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === iC-MU-38-7, iC-MU150-38-7
#- #- Not in this file: Frame size = 45: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,38,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,20,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"
