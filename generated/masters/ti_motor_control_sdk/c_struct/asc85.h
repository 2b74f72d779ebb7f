// TI motor-control SDK (Sitara, ICSS) with the order codes of ASC85 absolute encoders with a large thru-bore shaft. For
//   C, as structure initialisers.
// From the spec of ASC85 absolute encoders with a large thru-bore shaft, manual ASC85, revision 1.0.
// From the documents of the master: priv: TexasInstruments/motor-control-sdk at commit 1f61c0e, bissc_drv.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: priv: bissc_priv.
// single_turn_len and multi_turn_len take effect when bissc_update_data_len is called. [api: bissc_update_data_len]
// Clock, in MHz takes effect when bissc_clock_config is called. [api: bissc_clock_config]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=as_printed
//
//
// #define ASC8520_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 21, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8520/SC1, ASC8520/SC2 with zero_bit=left_out
//
//
// #define ASC8520_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 20, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=as_printed
//
//
// #define ASC8521_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 22, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8521/SC1, ASC8521/SC2 with zero_bit=left_out
//
//
// #define ASC8521_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 21, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=as_printed
//
//
// #define ASC8522_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 23, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8522/SC1, ASC8522/SC2 with zero_bit=left_out
//
//
// #define ASC8522_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 22, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=as_printed
//
//
// #define ASC8523_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 24, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8523/SC1, ASC8523/SC2 with zero_bit=left_out
//
//
// #define ASC8523_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 23, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=as_printed
//
//
// #define ASC8524_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 25, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8524/SC1, ASC8524/SC2 with zero_bit=left_out
//
//
// #define ASC8524_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 24, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=as_printed
//
//
// #define ASC8525_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 26, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === ASC8525/SC1, ASC8525/SC2 with zero_bit=left_out
//
//
// #define ASC8525_SC1_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 25, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }
