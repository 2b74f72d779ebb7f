#- AX8000 with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For ecmc, as commands for the
#-   slave ECMC_EC_SLAVE_NUM.
#- From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
#- From the documents of the master: rotary: AX8xxx object 32EF BiSS-C rotary encoder parameter; rotary_layout: AX8xxx
#-   object 32EF:05 data layout, rotary; power: AX8xxx object 32EF:02 power supply; fill: AX8xxx object 32EF fill bit
#-   count; rotary_steps: AX8xxx object 32EF:03 measuring steps per revolution; rotary_turns: AX8xxx object 32EF:04
#-   number of distinguishable revolutions; rotary_clock: AX8xxx object 32EF:09 max encoder clock frequency, rotary;
#-   rotary_inverted: AX8xxx object 32EF:0D CRC data inverted, rotary.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === ASC8520/SC1 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,1048576,8)"
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

#- === ASC8520/SC1 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,1048576,8)"
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

#- === ASC8520/SC2 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,1048576,8)"
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

#- === ASC8520/SC2 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,1048576,8)"
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

#- === ASC8521/SC1 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
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

#- === ASC8521/SC1 with zero_bit=left_out
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

#- === ASC8521/SC2 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
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

#- === ASC8521/SC2 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
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

#- === ASC8522/SC1 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,4194304,8)"
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

#- === ASC8522/SC1 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,4194304,8)"
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

#- === ASC8522/SC2 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,4194304,8)"
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

#- === ASC8522/SC2 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,4194304,8)"
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

#- === ASC8523/SC1 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
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

#- === ASC8523/SC1 with zero_bit=left_out
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

#- === ASC8523/SC2 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
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

#- === ASC8523/SC2 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
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

#- === ASC8524/SC1 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,16777216,8)"
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

#- === ASC8524/SC1 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,16777216,8)"
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

#- === ASC8524/SC2 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,16777216,8)"
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

#- === ASC8524/SC2 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,16777216,8)"
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

#- === ASC8525/SC1 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,33554432,8)"
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

#- === ASC8525/SC1 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,0,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,33554432,8)"
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

#- === ASC8525/SC2 with zero_bit=as_printed
#- #- Not in this file: Fill bit count right = 1: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,33554432,8)"
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

#- === ASC8525/SC2 with zero_bit=left_out
#- #- Not in this file: Fill bit count right = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: CRC polynome = 0x43: not given: index, subindex and a width in whole bytes.
#-
#- #- primary A
#- #- Power supply
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x2,2,4)"
#- #- Measuring steps per revolution
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x32EF,0x3,33554432,8)"
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
