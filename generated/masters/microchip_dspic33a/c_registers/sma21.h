// dsPIC33A with the order codes of SMA21 absolute linear encoder. For C, as register values and masks.
// From the spec of SMA21 absolute linear encoder, manual SMA21 + MTA-A154, revision 1.2.
// From the documents of the master: client: BiSS client configuration register B1CLTCONx; control: BiSS control
//   communication configuration register B1CTRLCON.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: client.
// Before writing any setting, CLCHCFGx (B1CHCON, BiSS C) must be 1. [example, code]
// Write SCDENx after SCDLENx, CRCSELx and CRCLENx. [example]
// After writing all settings, set ON (B1CON) to 1 and INIT (B1INSTR) to 1. [code, reading: steps 1 and 2]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === SMA21-SC1-0050, SMA21-SC1-0010, SMA21-SC1-0005, SMA21-SC1-0002, SMA21-SC4-0050, SMA21-SC4-0010, SMA21-SC4-0005,
//   SMA21-SC4-0002
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
// #define SMA21_SC1_0050_B1CLTCON0_MASK 0xFFFFFFFFU
// #define SMA21_SC1_0050_B1CLTCON0_VALUE 0x659U

// === SMA21-SC1-0001, SMA21-SC4-0001
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
// #define SMA21_SC1_0001_B1CLTCON0_MASK 0xFFFFFFFFU
// #define SMA21_SC1_0001_B1CLTCON0_VALUE 0x65AU
