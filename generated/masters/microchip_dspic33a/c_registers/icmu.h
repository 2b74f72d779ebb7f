// dsPIC33A with the order codes of iC-MU and iC-MU150 magnetic off-axis encoder chips. For C, as register values and
//   masks.
// From the spec of iC-MU and iC-MU150 magnetic off-axis encoder chips, manual iC-MU magnetic off-axis position encoder
//   - pole width 1.28 mm, revision D1.
// From the documents of the master: client: BiSS client configuration register B1CLTCONx; control: BiSS control
//   communication configuration register B1CTRLCON.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: client.
// Before writing any setting, CLCHCFGx (B1CHCON, BiSS C) must be 1. [example, code]
// Write SCDENx after SCDLENx, CRCSELx and CRCLENx. [example]
// After writing all settings, set ON (B1CON) to 1 and INIT (B1INSTR) to 1. [code, reading: steps 1 and 2]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === iC-MU-16-0, iC-MU150-16-0
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 17, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_16_0_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_16_0_B1CLTCON0_VALUE 0x651U

// === iC-MU-16-2, iC-MU150-16-2, iC-MU-18-0, iC-MU150-18-0
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 19, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_16_2_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_16_2_B1CLTCON0_VALUE 0x653U

// === iC-MU-16-7, iC-MU150-16-7
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 24, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_16_7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_16_7_B1CLTCON0_VALUE 0x658U

// === iC-MU-18-2, iC-MU150-18-2, iC-MU-20-0, iC-MU150-20-0
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 21, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_18_2_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_18_2_B1CLTCON0_VALUE 0x655U

// === iC-MU-18-7, iC-MU150-18-7
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 26, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_18_7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_18_7_B1CLTCON0_VALUE 0x65AU

// === iC-MU-19-0, iC-MU150-19-0
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 20, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_19_0_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_19_0_B1CLTCON0_VALUE 0x654U

// === iC-MU-19-2, iC-MU150-19-2
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 22, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_19_2_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_19_2_B1CLTCON0_VALUE 0x656U

// === iC-MU-19-7, iC-MU150-19-7, iC-MU-24-2, iC-MU150-24-2
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 27, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_19_7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_19_7_B1CLTCON0_VALUE 0x65BU

// === iC-MU-20-2, iC-MU150-20-2
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 23, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_20_2_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_20_2_B1CLTCON0_VALUE 0x657U

// === iC-MU-20-7, iC-MU150-20-7
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 28, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_20_7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_20_7_B1CLTCON0_VALUE 0x65CU

// === iC-MU-24-0, iC-MU150-24-0
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 25, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_24_0_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_24_0_B1CLTCON0_VALUE 0x659U

// === iC-MU-24-7, iC-MU150-24-7
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 32, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_24_7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_24_7_B1CLTCON0_VALUE 0x660U

// === iC-MU-28-0, iC-MU150-28-0
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 29, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_28_0_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_28_0_B1CLTCON0_VALUE 0x65DU

// === iC-MU-28-2, iC-MU150-28-2
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 31, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_28_2_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_28_2_B1CLTCON0_VALUE 0x65FU

// === iC-MU-28-7, iC-MU150-28-7
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 36, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_28_7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_28_7_B1CLTCON0_VALUE 0x664U

// === iC-MU-38-0, iC-MU150-38-0
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 39, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_38_0_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_38_0_B1CLTCON0_VALUE 0x667U

// === iC-MU-38-2, iC-MU150-38-2
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 41, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_38_2_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_38_2_B1CLTCON0_VALUE 0x669U

// === iC-MU-38-7, iC-MU150-38-7
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 46, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define iC_MU_38_7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define iC_MU_38_7_B1CLTCON0_VALUE 0x66EU
