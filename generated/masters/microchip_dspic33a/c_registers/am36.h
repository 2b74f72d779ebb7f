// dsPIC33A with the order codes of AM36 and AMC36 absolute multiturn encoders. For C, as register values and masks.
// From the spec of AM36 and AMC36 absolute multiturn encoders, manual AM36 AMC36, revision 1.0.
// From the documents of the master: client: BiSS client configuration register B1CLTCONx; control: BiSS control
//   communication configuration register B1CTRLCON.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: client.
// Before writing any setting, CLCHCFGx (B1CHCON, BiSS C) must be 1. [example, code]
// Write SCDENx after SCDLENx, CRCSELx and CRCLENx. [example]
// After writing all settings, set ON (B1CON) to 1 and INIT (B1INSTR) to 1. [code, reading: steps 1 and 2]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === AM3616/4096-I7, AM3619/4096-I7, AMC3616/4096-I7, AMC3619/4096-I7
// // Derived, not stated in a document: SCDLENx.
// // Not in this file: CLCHCFGx (B1CHCON, BiSS C) = 1: not given: register or address, with the bits.
// // Not in this file: SFREQ: unknown: it is a divider of the module clock, CLK: 0 is CLK / 2, 1 to 15 are CLK / 2 /
// //   (value + 1), 17 is CLK / 40, 18 to 31 are CLK / 20 / (value - 15).
//
// // client 0
// // B1CLTCON0, bits 5:0: SCDLENx = 37, derived
// // B1CLTCON0, bit 6: SCDENx = 1
// // B1CLTCON0, bit 7: GRAYx = 0
// // B1CLTCON0, bits 14:8: CRCLENx = 6
// // B1CLTCON0, bit 15: CRCSELx = 0
// // B1CLTCON0, bits 31:16: CRCSEEDx = 0
// #define AM3616_4096_I7_B1CLTCON0_MASK 0xFFFFFFFFU
// #define AM3616_4096_I7_B1CLTCON0_VALUE 0x665U
