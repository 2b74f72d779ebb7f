// TI C2000 PM_bissc with the order codes of SMA21 absolute linear encoder. For C, as structure initialisers.
// From the spec of SMA21 absolute linear encoder, manual SMA21 + MTA-A154, revision 1.2.
// From the documents of the master: header: C2000 position manager library, pm_bissc_include.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: header: PM_bissc_scdStruct.
// crcBits, positionMTBits and positionSTBits take effect when PM_bissc_initParams is called. [header:
//   PM_bissc_initParams]
// crcPoly takes effect when PM_bissc_initParams is called. * [header: PM_bissc_initParams also computes the CRC tables]
// freqDiv takes effect when PM_bissc_setFreq is called. [source: PM_bissc_setFreq]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === SMA21-SC1-0050, SMA21-SC1-0010, SMA21-SC1-0005, SMA21-SC1-0002, SMA21-SC4-0050, SMA21-SC4-0010, SMA21-SC4-0005,
//   SMA21-SC4-0002
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define SMA21_SC1_0050_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 24, /* positionSTBits */ \
// }

// === SMA21-SC1-0001, SMA21-SC4-0001
// // Not in this file: freqDiv: unknown: it is a divider of the chip clock. One period lasts until the counter reaches 2 *
// //   freqDiv. The clock must be within the limits of the encoder.
//
// #define SMA21_SC1_0001_PM_bissc_scdStruct { \
//     .crcBits = 6, /* crcBits */ \
//     .crcPoly = 3, /* crcPoly */ \
//     .crcStart = 0, /* crcStart */ \
//     .positionMTBits = 0, /* positionMTBits */ \
//     .positionSTBits = 25, /* positionSTBits */ \
// }
