// TI C2000 PM_bissc with the order codes of AM36 and AMC36 absolute multiturn encoders. For C, as structure
//   initialisers.
// From the spec of AM36 and AMC36 absolute multiturn encoders, manual AM36 AMC36, revision 1.0.
// From the documents of the master: header: C2000 position manager library, pm_bissc_include.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: header: PM_bissc_scdStruct.
// crcBits, positionMTBits and positionSTBits take effect when PM_bissc_initParams is called. [header:
//   PM_bissc_initParams]
// crcPoly takes effect when PM_bissc_initParams is called. * [header: PM_bissc_initParams also computes the CRC tables]
// freqDiv takes effect when PM_bissc_setFreq is called. [source: PM_bissc_setFreq]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === AM3616/4096-I7, AM3619/4096-I7, AMC3616/4096-I7, AMC3619/4096-I7
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define AM3616_4096_I7_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 16, /* positionMTBits */ \
//     .positionSTBits = 20, /* positionSTBits */ \
// }
