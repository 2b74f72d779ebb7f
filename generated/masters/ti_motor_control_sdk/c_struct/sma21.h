// TI motor-control SDK (Sitara, ICSS) with the order codes of SMA21 absolute linear encoder. For C, as structure
//   initialisers.
// From the spec of SMA21 absolute linear encoder, manual SMA21 + MTA-A154, revision 1.2.
// From the documents of the master: priv: TexasInstruments/motor-control-sdk at commit 1f61c0e, bissc_drv.h.
// Not yet tested on hardware. Not yet read by its tool. Form of the file: priv: bissc_priv.
// single_turn_len and multi_turn_len take effect when bissc_update_data_len is called. [api: bissc_update_data_len]
// Clock, in MHz takes effect when bissc_clock_config is called. [api: bissc_clock_config]
// Each block is for the first channel. A file that codewheel prints for one order code has all channels.
// Copy the lines below your order code and remove the first // of each line.

// === SMA21-SC1-0050, SMA21-SC1-0010, SMA21-SC1-0005, SMA21-SC1-0002, SMA21-SC4-0050, SMA21-SC4-0010, SMA21-SC4-0005,
//   SMA21-SC4-0002
//
//
// #define SMA21_SC1_0050_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 24, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }

// === SMA21-SC1-0001, SMA21-SC4-0001
//
//
// #define SMA21_SC1_0001_bissc_priv { \
//     .multi_turn_len = 0, /* multi_turn_len */ \
//     .single_turn_len = 25, /* single_turn_len */ \
//     .baud_rate = 10, /* Clock, in MHz */ \
// }
