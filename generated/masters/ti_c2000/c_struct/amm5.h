// TI C2000 PM_bissc with the order codes of AMM5A and AMM5B absolute kit encoders. For C, as structure initialisers.
// From the spec of AMM5A and AMM5B absolute kit encoders, manual AMM5A AMM5B, revision 1.9.
// From the documents of the master: header: C2000 position manager library, pm_bissc_include.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: header: PM_bissc_scdStruct.
// crcBits, positionMTBits and positionSTBits take effect when PM_bissc_initParams is called. [header:
//   PM_bissc_initParams]
// crcPoly takes effect when PM_bissc_initParams is called. * [header: PM_bissc_initParams also computes the CRC tables]
// freqDiv takes effect when PM_bissc_setFreq is called. [source: PM_bissc_setFreq]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === AMM5A17/1SC1, AMM5B17/1SC1
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define AMM5A17_1SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 17, /* positionSTBits */ \
// }

// === AMM5A17/65KSC1, AMM5B17/65KSC1
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define AMM5A17_65KSC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 16, /* positionMTBits */ \
//     .positionSTBits = 17, /* positionSTBits */ \
// }

// === AMM5A21/1SC1, AMM5B21/1SC1
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define AMM5A21_1SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 21, /* positionSTBits */ \
// }

// === AMM5A21/65KSC1, AMM5B21/65KSC1
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define AMM5A21_65KSC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 16, /* positionMTBits */ \
//     .positionSTBits = 21, /* positionSTBits */ \
// }

// === AMM5A23/1SC1, AMM5B23/1SC1
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define AMM5A23_1SC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 23, /* positionSTBits */ \
// }

// === AMM5A23/65KSC1, AMM5B23/65KSC1
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define AMM5A23_65KSC1_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 16, /* positionMTBits */ \
//     .positionSTBits = 23, /* positionSTBits */ \
// }
