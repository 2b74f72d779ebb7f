#- AX8000 with the order codes of iC-MU and iC-MU150 magnetic off-axis encoder chips. For ecmc, as commands for the
#-   slave ECMC_EC_SLAVE_NUM.
#- From the spec of iC-MU and iC-MU150 magnetic off-axis encoder chips, manual iC-MU magnetic off-axis position encoder
#-   - pole width 1.28 mm, revision D1.
#- From the documents of the master: rotary: AX8xxx object 32EF BiSS-C rotary encoder parameter; rotary_layout: AX8xxx
#-   object 32EF:05 data layout, rotary; fill: AX8xxx object 32EF fill bit count; rotary_steps: AX8xxx object 32EF:03
#-   measuring steps per revolution; rotary_turns: AX8xxx object 32EF:04 number of distinguishable revolutions;
#-   rotary_clock: AX8xxx object 32EF:09 max encoder clock frequency, rotary; rotary_inverted: AX8xxx object 32EF:0D CRC
#-   data inverted, rotary.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === iC-MU-16-0, iC-MU150-16-0, iC-MU-18-0, iC-MU150-18-0, iC-MU-19-0, iC-MU150-19-0, iC-MU-20-0, iC-MU150-20-0,
#-   iC-MU-24-0, iC-MU150-24-0, iC-MU-28-0, iC-MU150-28-0, iC-MU-38-0, iC-MU150-38-0
#- #- Not in this file: Measuring steps per revolution: unknown: not in the encoder's spec (counts per revolution).
#- #- Not in this file: Number of distinguishable revolutions: unknown: not in the encoder's spec (distinguishable
#- #-   revolutions).
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"

#- === iC-MU-16-2, iC-MU150-16-2, iC-MU-18-2, iC-MU150-18-2, iC-MU-19-2, iC-MU150-19-2, iC-MU-20-2, iC-MU150-20-2,
#-   iC-MU-24-2, iC-MU150-24-2, iC-MU-28-2, iC-MU150-28-2, iC-MU-38-2, iC-MU150-38-2
#- #- Not in this file: Measuring steps per revolution: unknown: not in the encoder's spec (counts per revolution).
#- #- Not in this file: Number of distinguishable revolutions: unknown: not in the encoder's spec (distinguishable
#- #-   revolutions).
#- #- Not in this file: Fill bit count right = 2: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"

#- === iC-MU-16-7, iC-MU150-16-7, iC-MU-18-7, iC-MU150-18-7, iC-MU-19-7, iC-MU150-19-7, iC-MU-20-7, iC-MU150-20-7,
#-   iC-MU-24-7, iC-MU150-24-7, iC-MU-28-7, iC-MU150-28-7, iC-MU-38-7, iC-MU150-38-7
#- #- Not in this file: Measuring steps per revolution: unknown: not in the encoder's spec (counts per revolution).
#- #- Not in this file: Number of distinguishable revolutions: unknown: not in the encoder's spec (distinguishable
#- #-   revolutions).
#- #- Not in this file: Fill bit count right = 7: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"
