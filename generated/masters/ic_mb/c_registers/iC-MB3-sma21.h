// iC-MB3 with the order codes of SMA21 absolute linear encoder. For C, as register values and masks.
// From the spec of SMA21 absolute linear encoder, manual SMA21 + MTA-A154, revision 1.2.
// From the documents of the master: mb3: iC-MB3 data sheet, Rev D1, p. 15.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: mb3: p. 15.
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === SMA21-SC1-0050, SMA21-SC1-0010, SMA21-SC1-0005, SMA21-SC1-0002, SMA21-SC4-0050, SMA21-SC4-0010, SMA21-SC4-0005,
//   SMA21-SC4-0002
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 25
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define SMA21_SC1_0050_ADDRESS_192_MASK 0xFFU
// #define SMA21_SC1_0050_ADDRESS_192_VALUE 0x59U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define SMA21_SC1_0050_ADDRESS_193_MASK 0xFFU
// #define SMA21_SC1_0050_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define SMA21_SC1_0050_ADDRESS_194_MASK 0x80U
// #define SMA21_SC1_0050_ADDRESS_194_VALUE 0x0U

// === SMA21-SC1-0001, SMA21-SC4-0001
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 26
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define SMA21_SC1_0001_ADDRESS_192_MASK 0xFFU
// #define SMA21_SC1_0001_ADDRESS_192_VALUE 0x5AU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define SMA21_SC1_0001_ADDRESS_193_MASK 0xFFU
// #define SMA21_SC1_0001_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define SMA21_SC1_0001_ADDRESS_194_MASK 0x80U
// #define SMA21_SC1_0001_ADDRESS_194_VALUE 0x0U
