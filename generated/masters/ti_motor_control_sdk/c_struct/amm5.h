// TI motor-control SDK (Sitara, ICSS) with the order codes of AMM5A and AMM5B absolute kit encoders. For C, as
//   structure initialisers.
// From the spec of AMM5A and AMM5B absolute kit encoders, manual AMM5A AMM5B, revision 1.9.
// From the documents of the master: priv: TexasInstruments/motor-control-sdk at commit 1f61c0e, bissc_drv.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: priv: bissc_priv.
// single_turn_len and multi_turn_len take effect when bissc_update_data_len is called. [api: bissc_update_data_len]
// Clock, in MHz takes effect when bissc_clock_config is called. [api: bissc_clock_config]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === AMM5A17/1SC1, AMM5B17/1SC1
//
//
// #define AMM5A17_1SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 17, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === AMM5A17/65KSC1, AMM5B17/65KSC1
//
//
// #define AMM5A17_65KSC1_bissc_priv { \
//     .multi_turn_len = 16, /* multi_turn_len */ \
//     .single_turn_len = 17, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === AMM5A21/1SC1, AMM5B21/1SC1
//
//
// #define AMM5A21_1SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 21, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === AMM5A21/65KSC1, AMM5B21/65KSC1
//
//
// #define AMM5A21_65KSC1_bissc_priv { \
//     .multi_turn_len = 16, /* multi_turn_len */ \
//     .single_turn_len = 21, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === AMM5A23/1SC1, AMM5B23/1SC1
//
//
// #define AMM5A23_1SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 23, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === AMM5A23/65KSC1, AMM5B23/65KSC1
//
//
// #define AMM5A23_65KSC1_bissc_priv { \
//     .multi_turn_len = 16, /* multi_turn_len */ \
//     .single_turn_len = 23, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }
