// The line of a BiSS C master: clocks a frame out of a slave, with any delay of the line and any acknowledge, and
// leaves MA at the inverse of CDM for the timeout.
module biss_master_line #(
    parameter [3:0] HALF = 4'd2  // clocks of this module in half a clock period of MA
) (
    input wire clk,
    input wire reset,
    input wire go,                 // a frame begins
    output reg ma,
    input wire slo,
    input wire [6:0] bits,         // of the word: data and CRC, 1 to 64
    input wire [7:0] timeout,
    input wire [7:0] most,         // clocks without a start bit after which the frame is aborted
    output reg [63:0] word,
    output reg cds,
    output reg seen,               // for one clock: CDS of this frame is valid
    input wire cdm,                // examined after the stop bit
    output reg done,               // for one clock: MA and SLO rest again
    output reg sound               // whether there was a frame with a stop bit
);
    localparam REST = 3'd0;
    localparam DELAY = 3'd1;        // SLO is still 1
    localparam ACKNOWLEDGE = 3'd2;
    localparam CONTROL = 3'd3;
    localparam DATA = 3'd4;
    localparam STOP = 3'd5;
    localparam TIMEOUT = 3'd6;
    localparam RETURN = 3'd7;       // the same time again, for the delay of the line

    reg [2:0] state;
    reg [3:0] phase;
    reg [7:0] count;

    wire half = phase == HALF - 4'd1;
    wire samples = half && !ma;  // MA rises with this clock. SLO still shows the result of the edge before.

    always @(posedge clk) begin
        seen <= 1'b0;
        done <= 1'b0;
        phase <= half ? 4'd0 : phase + 4'd1;
        if (reset) begin
            state <= REST;
            ma <= 1'b1;
            cds <= 1'b0;
            sound <= 1'b0;
        end else if (state == REST) begin
            phase <= 4'd0;
            count <= 8'd0;
            if (go) begin
                ma <= 1'b0;
                word <= 64'd0;
                state <= DELAY;
            end
        end else if (state == TIMEOUT) begin
            count <= count + 8'd1;
            if (count == {4'd0, HALF}) ma <= !(sound && cdm);
            if (count >= timeout) begin
                ma <= 1'b1;
                count <= 8'd0;
                state <= RETURN;
            end
        end else if (state == RETURN) begin
            count <= count + 8'd1;
            if (count >= timeout) begin
                done <= 1'b1;
                state <= REST;
            end
        end else begin
            if (half) ma <= !ma;
            if (samples) begin
                count <= count + 8'd1;
                case (state)
                    DELAY: if (!slo) state <= ACKNOWLEDGE;
                    ACKNOWLEDGE: if (slo) state <= CONTROL;
                    CONTROL: begin
                        cds <= slo;
                        seen <= 1'b1;
                        count <= 8'd1;
                        state <= DATA;
                    end
                    DATA: begin
                        word <= {word[62:0], slo};
                        if (count == {1'b0, bits}) state <= STOP;
                    end
                    default: begin  // STOP: the last edge
                        sound <= !slo;
                        count <= 8'd0;
                        state <= TIMEOUT;
                    end
                endcase
                if ((state == DELAY || state == ACKNOWLEDGE) && count >= most) begin
                    sound <= 1'b0;
                    ma <= 1'b1;
                    count <= 8'd0;
                    state <= TIMEOUT;
                end
            end
        end
    end
endmodule
