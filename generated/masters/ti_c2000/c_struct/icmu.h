// TI C2000 PM_bissc with the order codes of iC-MU and iC-MU150 magnetic off-axis encoder chips. For C, as structure
//   initialisers.
// From the spec of iC-MU and iC-MU150 magnetic off-axis encoder chips, manual iC-MU magnetic off-axis position encoder
//   - pole width 1.28 mm, revision D1.
// From the documents of the master: header: C2000 position manager library, pm_bissc_include.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: header: PM_bissc_scdStruct.
// crcBits, positionMTBits and positionSTBits take effect when PM_bissc_initParams is called. [header:
//   PM_bissc_initParams]
// crcPoly takes effect when PM_bissc_initParams is called. * [header: PM_bissc_initParams also computes the CRC tables]
// freqDiv takes effect when PM_bissc_setFreq is called. [source: PM_bissc_setFreq]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === iC-MU-16-0, iC-MU150-16-0
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_16_0_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 16, /* positionSTBits */ \
// }

// === iC-MU-16-2, iC-MU150-16-2, iC-MU-18-0, iC-MU150-18-0
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_16_2_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 18, /* positionSTBits */ \
// }

// === iC-MU-16-7, iC-MU150-16-7
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_16_7_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 23, /* positionSTBits */ \
// }

// === iC-MU-18-2, iC-MU150-18-2, iC-MU-20-0, iC-MU150-20-0
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_18_2_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 20, /* positionSTBits */ \
// }

// === iC-MU-18-7, iC-MU150-18-7
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_18_7_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 25, /* positionSTBits */ \
// }

// === iC-MU-19-0, iC-MU150-19-0
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_19_0_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 19, /* positionSTBits */ \
// }

// === iC-MU-19-2, iC-MU150-19-2
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_19_2_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 21, /* positionSTBits */ \
// }

// === iC-MU-19-7, iC-MU150-19-7, iC-MU-24-2, iC-MU150-24-2
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_19_7_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 26, /* positionSTBits */ \
// }

// === iC-MU-20-2, iC-MU150-20-2
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_20_2_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 22, /* positionSTBits */ \
// }

// === iC-MU-20-7, iC-MU150-20-7
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_20_7_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 27, /* positionSTBits */ \
// }

// === iC-MU-24-0, iC-MU150-24-0
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_24_0_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 24, /* positionSTBits */ \
// }

// === iC-MU-24-7, iC-MU150-24-7
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_24_7_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 31, /* positionSTBits */ \
// }

// === iC-MU-28-0, iC-MU150-28-0
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_28_0_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 28, /* positionSTBits */ \
// }

// === iC-MU-28-2, iC-MU150-28-2
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_28_2_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 30, /* positionSTBits */ \
// }

// === iC-MU-28-7, iC-MU150-28-7
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define iC_MU_28_7_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 35, /* positionSTBits */ \
// }
