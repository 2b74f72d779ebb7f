// TI motor-control SDK (Sitara, ICSS) with the order codes of iC-MU and iC-MU150 magnetic off-axis encoder chips. For
//   C, as structure initialisers.
// From the spec of iC-MU and iC-MU150 magnetic off-axis encoder chips, manual iC-MU magnetic off-axis position encoder
//   - pole width 1.28 mm, revision D1.
// From the documents of the master: priv: TexasInstruments/motor-control-sdk at commit 1f61c0e, bissc_drv.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: priv: bissc_priv.
// single_turn_len and multi_turn_len take effect when bissc_update_data_len is called. [api: bissc_update_data_len]
// Clock, in MHz takes effect when bissc_clock_config is called. [api: bissc_clock_config]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === iC-MU-16-0, iC-MU150-16-0
//
//
// #define iC_MU_16_0_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 16, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-16-2, iC-MU150-16-2, iC-MU-18-0, iC-MU150-18-0
//
//
// #define iC_MU_16_2_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 18, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-16-7, iC-MU150-16-7
//
//
// #define iC_MU_16_7_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 23, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-18-2, iC-MU150-18-2, iC-MU-20-0, iC-MU150-20-0
//
//
// #define iC_MU_18_2_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 20, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-18-7, iC-MU150-18-7
//
//
// #define iC_MU_18_7_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 25, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-19-0, iC-MU150-19-0
//
//
// #define iC_MU_19_0_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 19, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-19-2, iC-MU150-19-2
//
//
// #define iC_MU_19_2_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 21, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-19-7, iC-MU150-19-7, iC-MU-24-2, iC-MU150-24-2
//
//
// #define iC_MU_19_7_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 26, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-20-2, iC-MU150-20-2
//
//
// #define iC_MU_20_2_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 22, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-20-7, iC-MU150-20-7
//
//
// #define iC_MU_20_7_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 27, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-24-0, iC-MU150-24-0
//
//
// #define iC_MU_24_0_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 24, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-24-7, iC-MU150-24-7
//
//
// #define iC_MU_24_7_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 31, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-28-0, iC-MU150-28-0
//
//
// #define iC_MU_28_0_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 28, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-28-2, iC-MU150-28-2
//
//
// #define iC_MU_28_2_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 30, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-28-7, iC-MU150-28-7
//
//
// #define iC_MU_28_7_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 35, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-38-0, iC-MU150-38-0
//
//
// #define iC_MU_38_0_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 38, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-38-2, iC-MU150-38-2
//
//
// #define iC_MU_38_2_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 40, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === iC-MU-38-7, iC-MU150-38-7
//
//
// #define iC_MU_38_7_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 45, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }
