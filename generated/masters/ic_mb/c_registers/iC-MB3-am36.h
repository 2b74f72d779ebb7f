// iC-MB3 with the order codes of AM36 and AMC36 absolute multiturn encoders. For C, as register values and masks.
// From the spec of AM36 and AMC36 absolute multiturn encoders, manual AM36 AMC36, revision 1.0.
// From the documents of the master: mb3: iC-MB3 data sheet, Rev D1, p. 15.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: mb3: p. 15.
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === AM3616/4096-I7, AM3619/4096-I7, AMC3616/4096-I7, AMC3619/4096-I7
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 37
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define AM3616_4096_I7_ADDRESS_192_MASK 0xFFU
// #define AM3616_4096_I7_ADDRESS_192_VALUE 0x65U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define AM3616_4096_I7_ADDRESS_193_MASK 0xFFU
// #define AM3616_4096_I7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define AM3616_4096_I7_ADDRESS_194_MASK 0x80U
// #define AM3616_4096_I7_ADDRESS_194_VALUE 0x0U
