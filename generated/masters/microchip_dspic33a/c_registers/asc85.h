// dsPIC33A with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For C, as register values and
//   masks.
// From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
// From the documents of the master: client: BiSS client configuration register B1CLTCONx; control: BiSS control
//   communication configuration register B1CTRLCON.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: client.
// Before writing any setting, CLCHCFGx (B1CHCON, BiSS C) must be 1. [example, code]
// Write SCDENx after SCDLENx, CRCSELx and CRCLENx. [example]
// After writing all settings, set ON (B1CON) to 1 and INIT (B1INSTR) to 1. [code, reading: steps 1 and 2]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=as_printed
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
// #define ASC8520_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8520_SC1_B1CLTCON0_VALUE 0x656U

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=left_out
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
// #define ASC8520_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8520_SC1_B1CLTCON0_VALUE 0x655U

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=as_printed
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
// #define ASC8521_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8521_SC1_B1CLTCON0_VALUE 0x657U

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=left_out
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
// #define ASC8521_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8521_SC1_B1CLTCON0_VALUE 0x656U

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=as_printed
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
// #define ASC8522_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8522_SC1_B1CLTCON0_VALUE 0x658U

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=left_out
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
// #define ASC8522_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8522_SC1_B1CLTCON0_VALUE 0x657U

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=as_printed
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
// #define ASC8523_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8523_SC1_B1CLTCON0_VALUE 0x659U

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=left_out
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
// #define ASC8523_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8523_SC1_B1CLTCON0_VALUE 0x658U

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=as_printed
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
// #define ASC8524_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8524_SC1_B1CLTCON0_VALUE 0x65AU

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=left_out
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
// #define ASC8524_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8524_SC1_B1CLTCON0_VALUE 0x659U

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=as_printed
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
// #define ASC8525_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8525_SC1_B1CLTCON0_VALUE 0x65BU

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=left_out
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
// #define ASC8525_SC1_B1CLTCON0_MASK 0xFFFFFFFFU
// #define ASC8525_SC1_B1CLTCON0_VALUE 0x65AU
