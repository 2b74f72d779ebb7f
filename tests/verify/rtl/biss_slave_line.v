// The line of a BiSS C slave: gives a bit at SLO for each rising edge of MA, and takes the CDM bit of the timeout.
//
//   MA   1  ^1   ^2    ^3 ...          each edge brings the bit that the master samples at the next one
//   SLO  1   1    0    0 ... 1  CDS  D ... D  CRC ... CRC  0  0 ...  until the timeout, then 1
//
// The first rising edge stores the data; the second begins the acknowledge, which lasts one clock, and one more for
// each clock of processing. The clock of this module is so much faster than MA that no edge is missed.
module biss_slave_line #(
    parameter CRC_BITS = 6,
    parameter [CRC_BITS-1:0] CRC_POLYNOMIAL = 6'h03  // x^6 + x + 1, without its highest term
) (
    input wire clk,
    input wire reset,
    input wire ma,
    output reg slo,
    input wire [63:0] data,       // the bits before the CRC, the first in bit 63
    input wire [6:0] data_bits,   // 1 to 64
    input wire [7:0] processing,
    input wire [7:0] timeout,     // in clocks of this module without an edge of MA
    input wire cds,
    output reg cdm,
    output reg ended              // for one clock, at the end of the timeout: cdm is that of this frame
);
    localparam REST = 4'd0;
    localparam STORED = 4'd1;
    localparam ACKNOWLEDGE = 4'd2;
    localparam START = 4'd3;
    localparam DATA = 4'd4;
    localparam CRC = 4'd5;
    localparam OVER = 4'd6;
    localparam RETURN = 4'd7;  // after CDM = 1, MA rises once more, which is not an edge of a frame

    reg [3:0] state;
    reg ma_before;
    reg [7:0] quiet;
    reg [63:0] shift;
    reg [6:0] left;
    reg [7:0] waited;
    reg [CRC_BITS-1:0] crc;

    wire rises = ma && !ma_before;
    wire feedback = crc[CRC_BITS-1] ^ shift[63];

    always @(posedge clk) begin
        ma_before <= ma;
        ended <= 1'b0;
        quiet <= (ma != ma_before || state == REST || state == RETURN) ? 8'd0 : quiet + 8'd1;
        if (reset) begin
            state <= REST;
            ma_before <= 1'b1;
            slo <= 1'b1;
            cdm <= 1'b0;
            quiet <= 8'd0;
        end else if (quiet >= timeout) begin
            slo <= 1'b1;
            cdm <= !ma;
            ended <= (state == OVER);
            state <= RETURN;
            quiet <= 8'd0;
        end else if (state == RETURN) begin
            if (ma) state <= REST;
        end else if (rises) begin
            case (state)
                REST: begin
                    shift <= data;
                    state <= STORED;
                end
                STORED: begin
                    slo <= 1'b0;
                    waited <= 8'd0;
                    state <= ACKNOWLEDGE;
                end
                ACKNOWLEDGE:
                    if (waited >= processing) begin
                        slo <= 1'b1;
                        state <= START;
                    end else begin
                        waited <= waited + 8'd1;
                    end
                START: begin
                    slo <= cds;
                    left <= data_bits;
                    crc <= {CRC_BITS{1'b0}};
                    state <= DATA;
                end
                DATA: begin
                    slo <= shift[63];
                    shift <= shift << 1;
                    crc <= (crc << 1) ^ (feedback ? CRC_POLYNOMIAL : {CRC_BITS{1'b0}});
                    left <= left - 7'd1;
                    if (left == 7'd1) begin
                        left <= CRC_BITS;
                        state <= CRC;
                    end
                end
                CRC: begin
                    slo <= !crc[CRC_BITS-1];
                    crc <= crc << 1;
                    left <= left - 7'd1;
                    if (left == 7'd1) state <= OVER;
                end
                default: slo <= 1'b0;  // the stop bit, and any further clocks of the master
            endcase
        end
    end
endmodule
