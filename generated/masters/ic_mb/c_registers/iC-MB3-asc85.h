// iC-MB3 with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For C, as register values and
//   masks.
// From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
// From the documents of the master: mb3: iC-MB3 data sheet, Rev D1, p. 15.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: mb3: p. 15.
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=as_printed
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 22
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8520_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8520_SC1_ADDRESS_192_VALUE 0x56U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8520_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8520_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8520_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8520_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=left_out
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 21
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8520_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8520_SC1_ADDRESS_192_VALUE 0x55U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8520_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8520_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8520_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8520_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=as_printed
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 23
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8521_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8521_SC1_ADDRESS_192_VALUE 0x57U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8521_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8521_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8521_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8521_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=left_out
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 22
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8521_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8521_SC1_ADDRESS_192_VALUE 0x56U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8521_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8521_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8521_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8521_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=as_printed
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 24
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8522_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8522_SC1_ADDRESS_192_VALUE 0x58U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8522_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8522_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8522_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8522_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=left_out
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 23
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8522_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8522_SC1_ADDRESS_192_VALUE 0x57U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8522_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8522_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8522_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8522_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=as_printed
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 25
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8523_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8523_SC1_ADDRESS_192_VALUE 0x59U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8523_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8523_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8523_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8523_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=left_out
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 24
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8523_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8523_SC1_ADDRESS_192_VALUE 0x58U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8523_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8523_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8523_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8523_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=as_printed
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 26
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8524_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8524_SC1_ADDRESS_192_VALUE 0x5AU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8524_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8524_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8524_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8524_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=left_out
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 25
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8524_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8524_SC1_ADDRESS_192_VALUE 0x59U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8524_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8524_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8524_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8524_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=as_printed
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 27
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8525_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8525_SC1_ADDRESS_192_VALUE 0x5BU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8525_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8525_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8525_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8525_SC1_ADDRESS_194_VALUE 0x0U

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=left_out
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 26
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define ASC8525_SC1_ADDRESS_192_MASK 0xFFU
// #define ASC8525_SC1_ADDRESS_192_VALUE 0x5AU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define ASC8525_SC1_ADDRESS_193_MASK 0xFFU
// #define ASC8525_SC1_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define ASC8525_SC1_ADDRESS_194_MASK 0x80U
// #define ASC8525_SC1_ADDRESS_194_VALUE 0x0U
