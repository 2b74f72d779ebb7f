// iC-MB3 with the order codes of AMM5A and AMM5B absolute kit encoders. For C, as register values and masks.
// From the spec of AMM5A and AMM5B absolute kit encoders, manual AMM5A AMM5B, revision 1.9.
// From the documents of the master: mb3: iC-MB3 data sheet, Rev D1, p. 15.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: mb3: p. 15.
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === AMM5A17/1SC1, AMM5B17/1SC1
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 18
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define AMM5A17_1SC1_ADDRESS_192_MASK 0xFFU
// #define AMM5A17_1SC1_ADDRESS_192_VALUE 0x52U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define AMM5A17_1SC1_ADDRESS_193_MASK 0xFFU
// #define AMM5A17_1SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define AMM5A17_1SC1_ADDRESS_194_MASK 0x80U
// #define AMM5A17_1SC1_ADDRESS_194_VALUE 0x0U

// === AMM5A17/65KSC1, AMM5B17/65KSC1
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 34
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define AMM5A17_65KSC1_ADDRESS_192_MASK 0xFFU
// #define AMM5A17_65KSC1_ADDRESS_192_VALUE 0x62U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define AMM5A17_65KSC1_ADDRESS_193_MASK 0xFFU
// #define AMM5A17_65KSC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define AMM5A17_65KSC1_ADDRESS_194_MASK 0x80U
// #define AMM5A17_65KSC1_ADDRESS_194_VALUE 0x0U

// === AMM5A21/1SC1, AMM5B21/1SC1
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 22
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define AMM5A21_1SC1_ADDRESS_192_MASK 0xFFU
// #define AMM5A21_1SC1_ADDRESS_192_VALUE 0x56U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define AMM5A21_1SC1_ADDRESS_193_MASK 0xFFU
// #define AMM5A21_1SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define AMM5A21_1SC1_ADDRESS_194_MASK 0x80U
// #define AMM5A21_1SC1_ADDRESS_194_VALUE 0x0U

// === AMM5A21/65KSC1, AMM5B21/65KSC1
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 38
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define AMM5A21_65KSC1_ADDRESS_192_MASK 0xFFU
// #define AMM5A21_65KSC1_ADDRESS_192_VALUE 0x66U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define AMM5A21_65KSC1_ADDRESS_193_MASK 0xFFU
// #define AMM5A21_65KSC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define AMM5A21_65KSC1_ADDRESS_194_MASK 0x80U
// #define AMM5A21_65KSC1_ADDRESS_194_VALUE 0x0U

// === AMM5A23/1SC1, AMM5B23/1SC1
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 24
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define AMM5A23_1SC1_ADDRESS_192_MASK 0xFFU
// #define AMM5A23_1SC1_ADDRESS_192_VALUE 0x58U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define AMM5A23_1SC1_ADDRESS_193_MASK 0xFFU
// #define AMM5A23_1SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define AMM5A23_1SC1_ADDRESS_194_MASK 0x80U
// #define AMM5A23_1SC1_ADDRESS_194_VALUE 0x0U

// === AMM5A23/65KSC1, AMM5B23/65KSC1
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 40
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define AMM5A23_65KSC1_ADDRESS_192_MASK 0xFFU
// #define AMM5A23_65KSC1_ADDRESS_192_VALUE 0x68U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define AMM5A23_65KSC1_ADDRESS_193_MASK 0xFFU
// #define AMM5A23_65KSC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define AMM5A23_65KSC1_ADDRESS_194_MASK 0x80U
// #define AMM5A23_65KSC1_ADDRESS_194_VALUE 0x0U
