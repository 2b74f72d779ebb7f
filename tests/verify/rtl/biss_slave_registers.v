// Register access of a BiSS C slave, the only one of its line (ID 0): answers the CDM bit of each frame with the CDS
// bit of the next one.
//
//   CDM  14 x 0, S, CTS, ID2..0, ADR6..0, CRC3..0, R, W, S, DATA7..0, CRC3..0 (to read: 12 x 0), P, S ...
//   CDS          0  1    0 0 0   0 ...             0  R  W  S  DATA7..0 ...                      P ...  one frame later
//
// S is answered by 0 while the register is being fetched, or while the one before is being stored.
module biss_slave_registers #(
    parameter [7:0] READABLE_END = 8'h70,  // registers below this may be read
    parameter [7:0] WRITABLE = 8'h10,      // registers from here on, below the next one, may be written
    parameter [7:0] WRITABLE_END = 8'h60
) (
    input wire clk,
    input wire reset,
    input wire frame,                 // for one clock in each frame: cdm is valid
    input wire cdm,
    output reg cds,
    input wire [15:0] fetch_frames,   // how long a register is busy, sampled when that begins
    input wire [15:0] store_frames,
    output reg stored,                // for one clock: value was written to address
    output reg [6:0] address,
    output reg [7:0] value,
    input wire bank_write,            // the other side of the bank
    input wire [6:0] bank_address,
    input wire [7:0] bank_value,
    output wire [7:0] bank_held
);
    localparam OUTSIDE = 3'd0;
    localparam HEADER = 3'd1;
    localparam READ = 3'd2;
    localparam WRITE = 3'd3;
    localparam START = 3'd4;
    localparam BYTE = 3'd5;
    localparam STOP = 3'd6;

    reg [7:0] bank [0:127];
    assign bank_held = bank[bank_address];

    reg [2:0] state;
    reg [3:0] zeros;       // in a row, up to 14
    reg [3:0] at;          // received bits of the header or the byte
    reg [13:0] heard;
    reg [3:0] crc;         // x^4 + x + 1, start value 0
    reg [11:0] answer;
    reg writes;
    reg [15:0] busy;

    function [3:0] crc_next;
        input [3:0] so_far;
        input bit_in;
        crc_next = {so_far[2:0], 1'b0} ^ ((so_far[3] ^ bit_in) ? 4'b0011 : 4'b0000);
    endfunction

    function [3:0] crc_of_byte;
        input [7:0] of;
        integer place;
        begin
            crc_of_byte = 4'd0;
            for (place = 7; place >= 0; place = place - 1) crc_of_byte = crc_next(crc_of_byte, of[place]);
            crc_of_byte = ~crc_of_byte;
        end
    endfunction

    function allowed;
        input [6:0] register;
        input write;
        allowed = write ? ({1'b0, register} >= WRITABLE && {1'b0, register} < WRITABLE_END)
                        : ({1'b0, register} < READABLE_END);
    endfunction

    wire [14:0] header = {heard, cdm};
    wire [11:0] byte_heard = {heard[10:0], cdm};
    wire past_the_end = address[5:0] == 6'h3F;
    wire [6:0] address_after = address + 7'd1;

    always @(posedge clk) begin
        stored <= 1'b0;
        if (bank_write) bank[bank_address] <= bank_value;
        if (reset) begin
            state <= OUTSIDE;
            zeros <= 4'd0;
            cds <= 1'b0;
            busy <= 16'd0;
        end else if (frame) begin
            zeros <= cdm ? 4'd0 : (zeros == 4'd14) ? 4'd14 : zeros + 4'd1;
            if (busy != 16'd0) busy <= busy - 16'd1;
            heard <= header[13:0];
            at <= at + 4'd1;
            if (zeros >= 4'd13 && !cdm) begin  // the fourteenth
                state <= OUTSIDE;
                cds <= 1'b0;
            end else
                case (state)
                    OUTSIDE: begin
                        cds <= 1'b0;
                        if (cdm && zeros == 4'd14) begin
                            cds <= 1'b1;  // IDL0: the ID is taken
                            at <= 4'd0;
                            crc <= 4'd0;
                            state <= HEADER;
                        end
                    end
                    HEADER: begin
                        cds <= 1'b0;
                        if (at < 4'd11) crc <= crc_next(crc, cdm);
                        if (at == 4'd14) begin
                            address <= header[10:4];
                            // CTS = 1, ID = 0, and the CRC comes inverted
                            state <= (header[14:11] == 4'b1000 && header[3:0] == ~crc) ? READ : OUTSIDE;
                        end
                    end
                    READ: begin
                        cds <= cdm;
                        state <= WRITE;
                    end
                    WRITE: begin
                        writes <= cdm;
                        cds <= allowed(address, cdm) ? cdm : !cdm;
                        // R W is 10 or 01. Anything else is sent back unchanged.
                        state <= (heard[0] == cdm || !allowed(address, cdm)) ? OUTSIDE : START;
                        if (heard[0] == cdm) cds <= cdm;
                        if (!cdm && busy < fetch_frames) busy <= fetch_frames;
                    end
                    START: begin
                        cds <= cdm && busy == 16'd0;
                        at <= 4'd0;
                        answer <= {bank[address], crc_of_byte(bank[address])};
                        if (!cdm) state <= OUTSIDE;
                        else if (busy == 16'd0) state <= BYTE;
                    end
                    BYTE: begin
                        cds <= writes ? cdm : answer[11];
                        answer <= answer << 1;
                        if (at == 4'd11) begin
                            state <= STOP;
                            if (writes && byte_heard[3:0] != crc_of_byte(byte_heard[11:4])) state <= OUTSIDE;
                            else if (writes) begin
                                bank[address] <= byte_heard[11:4];
                                value <= byte_heard[11:4];
                                stored <= 1'b1;
                                busy <= store_frames;
                            end
                        end
                    end
                    default: begin  // STOP: the P of the master. This slave refuses the register that follows.
                        address <= past_the_end ? address : address_after;
                        cds <= past_the_end || !allowed(address_after, writes);
                        state <= (cdm || past_the_end || !allowed(address_after, writes)) ? OUTSIDE : START;
                        if (!writes && busy < fetch_frames) busy <= fetch_frames;
                    end
                endcase
        end
    end
endmodule
