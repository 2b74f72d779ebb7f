// Reads two BiSS frames with a clock of 1 MHz, and prints their single cycle data. Put your own master here.
module read_position;
    timeunit 1ns; timeprecision 1ns;

    logic ma = 1, slo;
    int bits, bits_left;
    logic [63:0] word;

    encoder line(.clock(ma), .data(slo));

    task automatic clock_once;
        #500 ma = 0;
        #500 ma = 1;
        #400;  // The data line is stable before the next edge.
    endtask

    initial begin
        if ($value$plusargs("bits=%d", bits) == 0) bits = 45;
        for (int frame = 0; frame < 2; frame++) begin
            #50000;  // the timeout
            word = 0;
            clock_once;
            clock_once;
            while (slo) clock_once;   // until the acknowledge
            while (!slo) clock_once;  // until the start bit
            clock_once;               // CDS
            for (bits_left = bits; bits_left > 0; bits_left--) begin
                clock_once;
                word = {word[62:0], slo};
            end
            $display("%h", word);
        end
        $finish;
    end
endmodule
