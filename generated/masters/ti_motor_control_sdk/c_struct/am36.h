// TI motor-control SDK (Sitara, ICSS) with the order codes of AM36 and AMC36 absolute multiturn encoders. For C, as
//   structure initialisers.
// From the spec of AM36 and AMC36 absolute multiturn encoders, manual AM36 AMC36, revision 1.0.
// From the documents of the master: priv: TexasInstruments/motor-control-sdk at commit 1f61c0e, bissc_drv.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: priv: bissc_priv.
// single_turn_len and multi_turn_len take effect when bissc_update_data_len is called. [api: bissc_update_data_len]
// Clock, in MHz takes effect when bissc_clock_config is called. [api: bissc_clock_config]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === AM3616/4096-I7, AM3619/4096-I7, AMC3616/4096-I7, AMC3619/4096-I7
//
//
// #define AM3616_4096_I7_bissc_priv { \
//     .multi_turn_len = 16, /* multi_turn_len */ \
//     .single_turn_len = 20, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }
