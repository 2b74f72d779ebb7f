// A BiSS C master: reads frames one after the other and, if requested, registers along with them.
module biss_master (
    input wire clk,
    input wire reset,
    input wire go,
    output wire ma,
    input wire slo,
    input wire [6:0] bits,
    input wire [7:0] timeout,
    input wire [7:0] most,
    output wire [63:0] word,
    output wire framed,            // for one clock: the frame is over
    output wire sound,
    input wire late,
    input wire ask,
    input wire write,
    input wire [6:0] first,
    input wire [6:0] count,
    input wire [15:0] busy_limit,
    input wire [7:0] to_write,
    output wire [7:0] value,
    output wire read,
    output wire [6:0] done,
    output wire [2:0] outcome
);
    wire cds;
    wire seen;
    wire cdm;
    reg cdm_before;                // the bit to send if it is one frame late

    biss_master_line line (
        .clk(clk), .reset(reset), .go(go), .ma(ma), .slo(slo), .bits(bits), .timeout(timeout), .most(most), .word(word),
        .cds(cds), .seen(seen), .cdm(late ? cdm_before : cdm), .done(framed), .sound(sound)
    );

    biss_master_registers registers (
        .clk(clk), .reset(reset), .late(late), .ask(ask), .write(write), .first(first), .count(count),
        .busy_limit(busy_limit), .frame(seen), .cds(cds), .lost(framed && !sound), .to_write(to_write), .value(value),
        .read(read), .done(done), .outcome(outcome), .cdm(cdm)
    );

    always @(posedge clk)
        if (reset) cdm_before <= 1'b0;
        else if (framed) cdm_before <= cdm;
endmodule
