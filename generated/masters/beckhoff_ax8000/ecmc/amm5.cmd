#- AX8000 with the order codes of AMM5A and AMM5B absolute kit encoders. For ecmc, as commands for the slave
#-   ECMC_EC_SLAVE_NUM.
#- From the spec of AMM5A and AMM5B absolute kit encoders, manual AMM5A AMM5B, revision 1.9.
#- From the documents of the master: rotary: AX8xxx object 32EF BiSS-C rotary encoder parameter; rotary_layout: AX8xxx
#-   object 32EF:05 data layout, rotary; power: AX8xxx object 32EF:02 power supply; fill: AX8xxx object 32EF fill bit
#-   count; rotary_steps: AX8xxx object 32EF:03 measuring steps per revolution; rotary_turns: AX8xxx object 32EF:04
#-   number of distinguishable revolutions; rotary_clock: AX8xxx object 32EF:09 max encoder clock frequency, rotary;
#-   rotary_inverted: AX8xxx object 32EF:0D CRC data inverted, rotary.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === AMM5A17/1SC1, AMM5B17/1SC1
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,131072,8)"
#- #- Number of distinguishable revolutions
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x4,1,8)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"

#- === AMM5A17/65KSC1, AMM5B17/65KSC1
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,131072,8)"
#- #- Number of distinguishable revolutions
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x4,65536,8)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"

#- === AMM5A21/1SC1, AMM5B21/1SC1
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,2097152,8)"
#- #- Number of distinguishable revolutions
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x4,1,8)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"

#- === AMM5A21/65KSC1, AMM5B21/65KSC1
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,2097152,8)"
#- #- Number of distinguishable revolutions
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x4,65536,8)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"

#- === AMM5A23/1SC1, AMM5B23/1SC1
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,8388608,8)"
#- #- Number of distinguishable revolutions
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x4,1,8)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"

#- === AMM5A23/65KSC1, AMM5B23/65KSC1
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,8388608,8)"
#- #- Number of distinguishable revolutions
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x4,65536,8)"
#- #- Data layout
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x5,0,1)"
#- #- Fill bit count left
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x6,0,1)"
#- #- Max encoder clock frequency, at most
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x9,10000,2)"
#- #- CRC data inverted
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0xD,1,1)"
