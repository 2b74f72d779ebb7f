// TI C2000 PM_bissc with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For C, as structure
//   initialisers.
// From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
// From the documents of the master: header: C2000 position manager library, pm_bissc_include.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: header: PM_bissc_scdStruct.
// crcBits, positionMTBits and positionSTBits take effect when PM_bissc_initParams is called. [header:
//   PM_bissc_initParams]
// crcPoly takes effect when PM_bissc_initParams is called. * [header: PM_bissc_initParams also computes the CRC tables]
// freqDiv takes effect when PM_bissc_setFreq is called. [source: PM_bissc_setFreq]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=as_printed
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8520_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 21, /* positionSTBits */ \
// }

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=left_out
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8520_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 20, /* positionSTBits */ \
// }

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=as_printed
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8521_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 22, /* positionSTBits */ \
// }

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=left_out
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8521_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 21, /* positionSTBits */ \
// }

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=as_printed
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8522_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 23, /* positionSTBits */ \
// }

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=left_out
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8522_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 22, /* positionSTBits */ \
// }

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=as_printed
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8523_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 24, /* positionSTBits */ \
// }

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=left_out
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8523_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 23, /* positionSTBits */ \
// }

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=as_printed
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8524_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 25, /* positionSTBits */ \
// }

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=left_out
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8524_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 24, /* positionSTBits */ \
// }

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=as_printed
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8525_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 26, /* positionSTBits */ \
// }

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=left_out
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define ASC8525_SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 25, /* positionSTBits */ \
// }
