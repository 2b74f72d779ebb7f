#- SOMANET Circulo with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For ecmc, as commands
#-   for the slave ECMC_EC_SLAVE_NUM.
#- From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
#- From the documents of the master: p834: SOMANET Circulo 7, documentation v4.19.0, p. 834; p835: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 835; p846: SOMANET Circulo 7, documentation v4.19.0, p. 846; p833: SOMANET Circulo 7,
#-   documentation v4.19.0, p. 833.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === ASC8520/BG1, ASC8520/BG2
#- #- Not in this file: Frame size = 20: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === ASC8520/GG1, ASC8520/GG2
#- #- Not in this file: Frame size = 20: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,20,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === ASC8521/BG1, ASC8521/BG2
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === ASC8521/GG1, ASC8521/GG2
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === ASC8522/BG1, ASC8522/BG2
#- #- Not in this file: Frame size = 22: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,22,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === ASC8522/GG1, ASC8522/GG2
#- #- Not in this file: Frame size = 22: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,22,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === ASC8523/BG1, ASC8523/BG2
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === ASC8523/GG1, ASC8523/GG2
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
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === ASC8524/BG1, ASC8524/BG2
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,24,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === ASC8524/GG1, ASC8524/GG2
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,24,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === ASC8525/BG1, ASC8525/BG2
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,25,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,0,1)"

#- === ASC8525/GG1, ASC8525/GG2
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,25,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- Timeout, in µs, at least
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xE,12,1)"
#- #- Parity type
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x12,0,1)"
#- #- First clock delay
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x13,0,2)"
#- #- Data ordering
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x14,1,1)"

#- === ASC8520/SC1, ASC8520/SC2 with zero_bit=as_printed
#- #- Not in this file: Frame size = 21: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8520/SC1, ASC8520/SC2 with zero_bit=left_out
#- #- Not in this file: Frame size = 20: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8521/SC1, ASC8521/SC2 with zero_bit=as_printed
#- #- Not in this file: Frame size = 22: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8521/SC1, ASC8521/SC2 with zero_bit=left_out
#- #- Not in this file: Frame size = 21: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8522/SC1, ASC8522/SC2 with zero_bit=as_printed
#- #- Not in this file: Frame size = 23: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,22,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8522/SC1, ASC8522/SC2 with zero_bit=left_out
#- #- Not in this file: Frame size = 22: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
#- #- Not in this file: Maximum tbusy, in µs: unknown: not in the encoder's spec (longest processing time before the start
#- #-   bit, in µs, BiSS).
#-
#- #- encoder 1
#- #- Multiturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xA,0,1)"
#- #- Singleturn bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xC,22,1)"
#- #- Singleturn first bit position
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xD,0,1)"
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8523/SC1, ASC8523/SC2 with zero_bit=as_printed
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8523/SC1, ASC8523/SC2 with zero_bit=left_out
#- #- Not in this file: Frame size = 23: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8524/SC1, ASC8524/SC2 with zero_bit=as_printed
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8524/SC1, ASC8524/SC2 with zero_bit=left_out
#- #- Not in this file: Frame size = 24: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8525/SC1, ASC8525/SC2 with zero_bit=as_printed
#- #- Not in this file: Frame size = 26: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"

#- === ASC8525/SC1, ASC8525/SC2 with zero_bit=left_out
#- #- Not in this file: Frame size = 25: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Timeout, in µs: unknown: not in the encoder's spec (longest time-out of the encoder, in µs, BiSS).
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
#- #- CRC polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0xF,67,1)"
#- #- Status bits active value
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x2110,0x11,0,1)"
