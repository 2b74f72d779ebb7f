// An encoder as a module of a simulation, over BiSS (MA and SLO) or SSI. Start it with +port=PORT.
module encoder #(
    parameter int TIMEOUT_US = 20  // of the encoder: without an edge of the clock for this time, a frame is over
) (
    input  logic clock,
    output logic data
);
    timeunit 1ns; timeprecision 1ns;

    import "DPI-C" function int line_open(input int port);
    import "DPI-C" function int line_level(input int handle, input int level);
    import "DPI-C" function int line_timeout(input int handle);

    int port, line = -1, idle_us = 0;

    initial begin
        if ($value$plusargs("port=%d", port) == 0) port = 0;
        line = line_open(port);
        if (line < 0) $fatal(1, "no virtual encoder at port %0d", port);
        data = 1;
    end

    always @(clock)
        if (line >= 0) begin
            data = line_level(line, {31'b0, clock}) == 1;
            idle_us = 0;
        end

    always #1000
        if (line >= 0 && idle_us <= TIMEOUT_US) begin
            idle_us = idle_us + 1;
            if (idle_us == TIMEOUT_US) data = line_timeout(line) == 1;
        end
endmodule
