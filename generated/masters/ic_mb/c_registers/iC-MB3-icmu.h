// iC-MB3 with the order codes of iC-MU and iC-MU150 magnetic off-axis encoder chips. For C, as register values and
//   masks.
// From the spec of iC-MU and iC-MU150 magnetic off-axis encoder chips, manual iC-MU magnetic off-axis position encoder
//   - pole width 1.28 mm, revision D1.
// From the documents of the master: mb3: iC-MB3 data sheet, Rev D1, p. 15.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: mb3: p. 15.
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === iC-MU-16-0, iC-MU150-16-0
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 17
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_16_0_ADDRESS_192_MASK 0xFFU
// #define iC_MU_16_0_ADDRESS_192_VALUE 0x51U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_16_0_ADDRESS_193_MASK 0xFFU
// #define iC_MU_16_0_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_16_0_ADDRESS_194_MASK 0x80U
// #define iC_MU_16_0_ADDRESS_194_VALUE 0x0U

// === iC-MU-16-2, iC-MU150-16-2, iC-MU-18-0, iC-MU150-18-0
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 19
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_16_2_ADDRESS_192_MASK 0xFFU
// #define iC_MU_16_2_ADDRESS_192_VALUE 0x53U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_16_2_ADDRESS_193_MASK 0xFFU
// #define iC_MU_16_2_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_16_2_ADDRESS_194_MASK 0x80U
// #define iC_MU_16_2_ADDRESS_194_VALUE 0x0U

// === iC-MU-16-7, iC-MU150-16-7
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 24
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_16_7_ADDRESS_192_MASK 0xFFU
// #define iC_MU_16_7_ADDRESS_192_VALUE 0x58U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_16_7_ADDRESS_193_MASK 0xFFU
// #define iC_MU_16_7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_16_7_ADDRESS_194_MASK 0x80U
// #define iC_MU_16_7_ADDRESS_194_VALUE 0x0U

// === iC-MU-18-2, iC-MU150-18-2, iC-MU-20-0, iC-MU150-20-0
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 21
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_18_2_ADDRESS_192_MASK 0xFFU
// #define iC_MU_18_2_ADDRESS_192_VALUE 0x55U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_18_2_ADDRESS_193_MASK 0xFFU
// #define iC_MU_18_2_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_18_2_ADDRESS_194_MASK 0x80U
// #define iC_MU_18_2_ADDRESS_194_VALUE 0x0U

// === iC-MU-18-7, iC-MU150-18-7
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 26
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_18_7_ADDRESS_192_MASK 0xFFU
// #define iC_MU_18_7_ADDRESS_192_VALUE 0x5AU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_18_7_ADDRESS_193_MASK 0xFFU
// #define iC_MU_18_7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_18_7_ADDRESS_194_MASK 0x80U
// #define iC_MU_18_7_ADDRESS_194_VALUE 0x0U

// === iC-MU-19-0, iC-MU150-19-0
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 20
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_19_0_ADDRESS_192_MASK 0xFFU
// #define iC_MU_19_0_ADDRESS_192_VALUE 0x54U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_19_0_ADDRESS_193_MASK 0xFFU
// #define iC_MU_19_0_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_19_0_ADDRESS_194_MASK 0x80U
// #define iC_MU_19_0_ADDRESS_194_VALUE 0x0U

// === iC-MU-19-2, iC-MU150-19-2
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 22
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_19_2_ADDRESS_192_MASK 0xFFU
// #define iC_MU_19_2_ADDRESS_192_VALUE 0x56U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_19_2_ADDRESS_193_MASK 0xFFU
// #define iC_MU_19_2_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_19_2_ADDRESS_194_MASK 0x80U
// #define iC_MU_19_2_ADDRESS_194_VALUE 0x0U

// === iC-MU-19-7, iC-MU150-19-7, iC-MU-24-2, iC-MU150-24-2
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 27
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_19_7_ADDRESS_192_MASK 0xFFU
// #define iC_MU_19_7_ADDRESS_192_VALUE 0x5BU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_19_7_ADDRESS_193_MASK 0xFFU
// #define iC_MU_19_7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_19_7_ADDRESS_194_MASK 0x80U
// #define iC_MU_19_7_ADDRESS_194_VALUE 0x0U

// === iC-MU-20-2, iC-MU150-20-2
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 23
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_20_2_ADDRESS_192_MASK 0xFFU
// #define iC_MU_20_2_ADDRESS_192_VALUE 0x57U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_20_2_ADDRESS_193_MASK 0xFFU
// #define iC_MU_20_2_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_20_2_ADDRESS_194_MASK 0x80U
// #define iC_MU_20_2_ADDRESS_194_VALUE 0x0U

// === iC-MU-20-7, iC-MU150-20-7
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 28
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_20_7_ADDRESS_192_MASK 0xFFU
// #define iC_MU_20_7_ADDRESS_192_VALUE 0x5CU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_20_7_ADDRESS_193_MASK 0xFFU
// #define iC_MU_20_7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_20_7_ADDRESS_194_MASK 0x80U
// #define iC_MU_20_7_ADDRESS_194_VALUE 0x0U

// === iC-MU-24-0, iC-MU150-24-0
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 25
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_24_0_ADDRESS_192_MASK 0xFFU
// #define iC_MU_24_0_ADDRESS_192_VALUE 0x59U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_24_0_ADDRESS_193_MASK 0xFFU
// #define iC_MU_24_0_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_24_0_ADDRESS_194_MASK 0x80U
// #define iC_MU_24_0_ADDRESS_194_VALUE 0x0U

// === iC-MU-24-7, iC-MU150-24-7
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 32
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_24_7_ADDRESS_192_MASK 0xFFU
// #define iC_MU_24_7_ADDRESS_192_VALUE 0x60U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_24_7_ADDRESS_193_MASK 0xFFU
// #define iC_MU_24_7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_24_7_ADDRESS_194_MASK 0x80U
// #define iC_MU_24_7_ADDRESS_194_VALUE 0x0U

// === iC-MU-28-0, iC-MU150-28-0
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 29
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_28_0_ADDRESS_192_MASK 0xFFU
// #define iC_MU_28_0_ADDRESS_192_VALUE 0x5DU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_28_0_ADDRESS_193_MASK 0xFFU
// #define iC_MU_28_0_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_28_0_ADDRESS_194_MASK 0x80U
// #define iC_MU_28_0_ADDRESS_194_VALUE 0x0U

// === iC-MU-28-2, iC-MU150-28-2
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 31
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_28_2_ADDRESS_192_MASK 0xFFU
// #define iC_MU_28_2_ADDRESS_192_VALUE 0x5FU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_28_2_ADDRESS_193_MASK 0xFFU
// #define iC_MU_28_2_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_28_2_ADDRESS_194_MASK 0x80U
// #define iC_MU_28_2_ADDRESS_194_VALUE 0x0U

// === iC-MU-28-7, iC-MU150-28-7
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 36
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_28_7_ADDRESS_192_MASK 0xFFU
// #define iC_MU_28_7_ADDRESS_192_VALUE 0x64U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_28_7_ADDRESS_193_MASK 0xFFU
// #define iC_MU_28_7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_28_7_ADDRESS_194_MASK 0x80U
// #define iC_MU_28_7_ADDRESS_194_VALUE 0x0U

// === iC-MU-38-0, iC-MU150-38-0
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 39
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_38_0_ADDRESS_192_MASK 0xFFU
// #define iC_MU_38_0_ADDRESS_192_VALUE 0x67U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_38_0_ADDRESS_193_MASK 0xFFU
// #define iC_MU_38_0_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_38_0_ADDRESS_194_MASK 0x80U
// #define iC_MU_38_0_ADDRESS_194_VALUE 0x0U

// === iC-MU-38-2, iC-MU150-38-2
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 41
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_38_2_ADDRESS_192_MASK 0xFFU
// #define iC_MU_38_2_ADDRESS_192_VALUE 0x69U
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_38_2_ADDRESS_193_MASK 0xFFU
// #define iC_MU_38_2_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_38_2_ADDRESS_194_MASK 0x80U
// #define iC_MU_38_2_ADDRESS_194_VALUE 0x0U

// === iC-MU-38-7, iC-MU150-38-7
// // Not in this file: Clock: unknown: see the data sheet for the register. The clock must be within the limits of the
// //   encoder.
//
// // slave 1
// // address 192, bits 5:0: SDLEN = 46
// // address 192, bit 6: ENSENS = 1
// // address 192, bit 7: ACTnSENS = 0
// #define iC_MU_38_7_ADDRESS_192_MASK 0xFFU
// #define iC_MU_38_7_ADDRESS_192_VALUE 0x6EU
// // address 193, bits 6:0: SENSCRCPOLY = 33
// // address 193, bit 7: INVCRCS = 1
// #define iC_MU_38_7_ADDRESS_193_MASK 0xFFU
// #define iC_MU_38_7_ADDRESS_193_VALUE 0xA1U
// // address 194, bit 7: GRAY = 0
// #define iC_MU_38_7_ADDRESS_194_MASK 0x80U
// #define iC_MU_38_7_ADDRESS_194_VALUE 0x0U
