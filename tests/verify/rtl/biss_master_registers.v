// Register access of a BiSS C master on a line with one slave, whose ID is 0: takes the CDS bit of each frame and gives
// a CDM bit. It stores which bits it has sent, so that it knows which bit each answer belongs to: the next CDS answers
// the last bit or, if bits are sent one frame late, the bit before it.
module biss_master_registers (
    input wire clk,
    input wire reset,
    input wire late,
    input wire ask,                 // for one clock: begin with the following request
    input wire write,
    input wire [6:0] first,         // address of the first register
    input wire [6:0] count,         // how many, 1 to 64
    input wire [15:0] busy_limit,   // how often S may stay without an answer
    input wire frame,               // for one clock: cds is valid
    input wire cds,
    input wire lost,                // for one clock, instead of frame: there is none
    input wire [7:0] to_write,      // value to write to register number done of the access
    output reg [7:0] value,         // what was read
    output reg read,                // for one clock: value is that of register number done - 1
    output reg [6:0] done,
    output reg [2:0] outcome,
    output reg cdm
);
    localparam IDLE = 3'd0;
    localparam RUNNING = 3'd1;
    localparam DONE = 3'd2;
    localparam REFUSED = 3'd3;
    localparam BUSY = 3'd4;
    localparam DISTURBED = 3'd5;

    // Parts of a control frame, both of the sent bits and of those that an answer belongs to.
    localparam NOTHING = 3'd0;      // zeros before and after
    localparam ID = 3'd1;           // S, CTS, ID, ADR, CRC
    localparam R = 3'd2;
    localparam W = 3'd3;
    localparam S = 3'd4;
    localparam DATA = 3'd5;         // DATA, CRC
    localparam P = 3'd6;

    // The bit sent last: its part, and its number in that part, from 1 on; and the bit before it.
    reg [2:0] part;
    reg [4:0] at;
    reg [2:0] part_before;
    reg [4:0] at_before;
    wire [2:0] answered = late ? part_before : part;
    wire [4:0] answered_at = late ? at_before : at;

    reg [6:0] address;
    reg [15:0] busy;
    reg [15:0] sending;             // the bits after the last one, the next one first
    reg [11:0] sent;                // DATA and CRC
    reg [10:0] heard;
    wire [11:0] answers = {heard, cds};

    function [3:0] crc;             // x^4 + x + 1, start value 0, inverted
        input [10:0] data;          // leading zeros change nothing
        integer place;
        begin
            crc = 4'd0;
            for (place = 10; place >= 0; place = place - 1)
                crc = {crc[2:0], 1'b0} ^ ((crc[3] ^ data[place]) ? 4'b0011 : 4'b0000);
            crc = ~crc;
        end
    endfunction

    wire [10:0] asked = {4'b1000, address};  // CTS = 1, ID = 0
    wire [11:0] byte_to_send = write ? {to_write, crc({3'd0, to_write})} : 12'd0;
    wire byte_over = answered == DATA && answered_at == 5'd12;
    wire byte_sound = write ? answers == sent : answers[3:0] == crc({3'd0, answers[11:4]});
    wire start_missing = answered == S && !cds;

    // The result of the access after an answer: RUNNING, or how it ended.
    reg [2:0] verdict;
    always @* begin
        verdict = RUNNING;
        case (answered)
            ID: if (cds != (answered_at == 5'd1)) verdict = DISTURBED;  // the first ID is taken, no other
            R: if (cds == write) verdict = DISTURBED;
            W: if (cds != write) verdict = REFUSED;
            S: if (!cds && busy == busy_limit) verdict = BUSY;
            DATA: if (byte_over && !byte_sound) verdict = DISTURBED;
                  else if (byte_over && done + 7'd1 == count) verdict = DONE;
            P: if (cds) verdict = REFUSED;
            default: verdict = RUNNING;
        endcase
    end

    // The part of the next bit.
    reg [2:0] next;
    always @* begin
        next = part;
        case (part)
            NOTHING: if (at == 5'd14) next = ID;
            ID: if (at == 5'd16) next = R;
            R: next = W;
            W: next = S;
            S: next = (late || cds) ? DATA : S;
            DATA: next = (late && start_missing) ? NOTHING : (at == 5'd12) ? P : DATA;
            default: next = S;
        endcase
        if (verdict != RUNNING) next = NOTHING;
    end

    always @(posedge clk) begin
        read <= 1'b0;
        if (reset || ask) begin
            outcome <= reset ? IDLE : RUNNING;
            part <= NOTHING;
            part_before <= NOTHING;
            at <= 5'd0;
            done <= 7'd0;
            busy <= 16'd0;
            address <= first;
            cdm <= 1'b0;
        end else if (outcome != RUNNING || lost) begin
            if (outcome == RUNNING) outcome <= DISTURBED;
            if (frame || lost) cdm <= 1'b0;
        end else if (frame) begin
            outcome <= verdict;
            part_before <= (next == NOTHING) ? NOTHING : part;
            at_before <= at;
            part <= next;
            at <= (next == part) ? at + 5'd1 : 5'd1;
            heard <= answers[10:0];
            sending <= sending << 1;
            cdm <= sending[15];
            case (next)
                ID: if (part != ID) begin
                    cdm <= 1'b1;
                    sending <= {asked, crc(asked), 1'b0};
                end
                R: cdm <= !write;
                W: cdm <= write;
                S: cdm <= 1'b1;
                DATA: if (part != DATA) begin
                    cdm <= byte_to_send[11];
                    sending <= {byte_to_send[10:0], 5'd0};
                    sent <= byte_to_send;
                end
                default: cdm <= 1'b0;
            endcase
            if (start_missing) busy <= busy + 16'd1;
            if (byte_over && byte_sound) begin
                value <= answers[11:4];
                read <= !write;
                done <= done + 7'd1;
                address <= address + 7'd1;
                busy <= 16'd0;
            end
        end
    end
endmodule
