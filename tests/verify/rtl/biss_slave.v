// A BiSS C slave: its line, and its registers, or external ones that answer instead.
module biss_slave (
    input wire clk,
    input wire reset,
    input wire ma,
    output wire slo,
    input wire [63:0] data,
    input wire [6:0] data_bits,
    input wire [7:0] processing,
    input wire [7:0] timeout,
    input wire disturb_cdm,        // flips the bit on its way
    input wire disturb_cds,
    input wire outside,            // whether CDS comes from outside_cds
    input wire outside_cds,
    output wire cdm,
    output wire ended,
    input wire [15:0] fetch_frames,
    input wire [15:0] store_frames,
    output wire stored,
    output wire [6:0] address,
    output wire [7:0] value,
    input wire bank_write,
    input wire [6:0] bank_address,
    input wire [7:0] bank_value,
    output wire [7:0] bank_held
);
    wire received;
    wire answered;
    assign cdm = received ^ disturb_cdm;

    biss_slave_line line (
        .clk(clk), .reset(reset), .ma(ma), .slo(slo), .data(data), .data_bits(data_bits), .processing(processing),
        .timeout(timeout), .cds((outside ? outside_cds : answered) ^ disturb_cds), .cdm(received), .ended(ended)
    );

    biss_slave_registers registers (
        .clk(clk), .reset(reset), .frame(ended), .cdm(cdm), .cds(answered), .fetch_frames(fetch_frames),
        .store_frames(store_frames), .stored(stored), .address(address), .value(value), .bank_write(bank_write),
        .bank_address(bank_address), .bank_value(bank_value), .bank_held(bank_held)
    );
endmodule
