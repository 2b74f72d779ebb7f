#- EP7041-4032 with the order codes of iC-MU and iC-MU150 magnetic off-axis encoder chips. For ecmc, as commands for the
#-   slave ECMC_EC_SLAVE_NUM.
#- From the spec of iC-MU and iC-MU150 magnetic off-axis encoder chips, manual iC-MU magnetic off-axis position encoder
#-   - pole width 1.28 mm, revision D1.
#- From the documents of the master: ep7041_objects: EP7041-4032 configuration objects.
#- Not yet tested on hardware. Read by the scripts of ecmccomp, see docs/master-files.md. Form of the file: ecmc.
#- Write Disable Status Bits and CRC Polynomial after Mode. * [ssi: Mode sets both, ep7041_biss: steps 2 and 3,
#-   ep7041_ssi: steps 2 and 3]
#- Each block is for the first channel. A file that codewheel prints for one order code has all channels.
#- Copy the lines below your order code and remove the first #- of each line.

#- === iC-MU-16-0, iC-MU150-16-0
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,16,1)"

#- === iC-MU-16-2, iC-MU150-16-2
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 2: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,16,1)"

#- === iC-MU-16-7, iC-MU150-16-7
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 7: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,16,1)"

#- === iC-MU-18-0, iC-MU150-18-0
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,18,1)"

#- === iC-MU-18-2, iC-MU150-18-2
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 2: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,18,1)"

#- === iC-MU-18-7, iC-MU150-18-7
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 7: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,18,1)"

#- === iC-MU-19-0, iC-MU150-19-0
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,19,1)"

#- === iC-MU-19-2, iC-MU150-19-2
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 2: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,19,1)"

#- === iC-MU-19-7, iC-MU150-19-7
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 7: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,19,1)"

#- === iC-MU-20-0, iC-MU150-20-0
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === iC-MU-20-2, iC-MU150-20-2
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 2: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === iC-MU-20-7, iC-MU150-20-7
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 7: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,20,1)"

#- === iC-MU-24-0, iC-MU150-24-0
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === iC-MU-24-2, iC-MU150-24-2
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 2: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === iC-MU-24-7, iC-MU150-24-7
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 7: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,24,1)"

#- === iC-MU-28-0, iC-MU150-28-0
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,28,1)"

#- === iC-MU-28-2, iC-MU150-28-2
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 2: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,28,1)"

#- === iC-MU-28-7, iC-MU150-28-7
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 7: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,28,1)"

#- === iC-MU-38-0, iC-MU150-38-0
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 0: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,38,1)"

#- === iC-MU-38-2, iC-MU150-38-2
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 2: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,38,1)"

#- === iC-MU-38-7, iC-MU150-38-7
#- #- Not in this file: Mode = 0: not given: index, subindex and a width in whole bytes.
#- #- Not in this file: Offset LSB Bit [Bit] = 7: not given: index, subindex and a width in whole bytes.
#- #- Disable Status Bits
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x2,0,1)"
#- #- CRC Invert
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x3,1,1)"
#- #- CRC Polynomial
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x11,67,4)"
#- #- Clock Frequency, EL5042 and EP7041-4032
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x13,0,1)"
#- #- Coding
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x14,0,1)"
#- #- Multiturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x15,0,1)"
#- #- Singleturn [Bit]
#- ecmcConfigOrDie "Cfg.EcAddSdo(${ECMC_EC_SLAVE_NUM},0x8008,0x16,38,1)"
