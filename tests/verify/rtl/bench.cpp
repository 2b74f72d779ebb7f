// The master and the slave in Verilog on a line with delay and disturbances, for ctypes. The master is the one in
// Verilog, or an SPI as in a microcontroller: a number of clocks, MA high at rest, SLO sampled at each rising edge.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>

#include "Vbiss_master.h"
#include "Vbiss_slave.h"

namespace {

// SLO up to 255 clocks ago.
struct Delay {
    uint8_t past[256] = {};
    uint8_t at = 0;

    bool step(bool bit, uint8_t clocks)
    {
        past[++at] = bit;
        return past[static_cast<uint8_t>(at - clocks)] != 0;
    }

    void rest()
    {
        std::fill(std::begin(past), std::end(past), uint8_t{1});
    }
};

struct Bench {
    VerilatedContext context;
    Vbiss_master master{&context};
    Vbiss_slave slave{&context};
    Delay line;
    uint8_t delay = 0;
    uint8_t half = 2;     // clocks in half a clock period of MA
    bool cut = false;     // the cable is cut: SLO stays 1
    bool of_spi = true;   // who has MA
    bool ma = true;
    bool slo = true;
    int32_t stored = -1;  // the register stored last, and its value, in 8 bits each
    int taken = -1;
    uint8_t *rx = nullptr;
    size_t places = 0;    // number of samples in rx
    size_t place = 0;

    // A clock of both modules, after which MA is set by the master or by the SPI.
    void step()
    {
        const bool ma_before = of_spi ? ma : master.ma != 0;
        slave.ma = ma_before;
        master.slo = slo;
        for (const uint8_t level : {0, 1}) {
            master.clk = level;
            slave.clk = level;
            master.eval();
            slave.eval();
        }
        if (!of_spi && !ma_before && master.ma != 0) {
            sample();
        }
        slo = line.step(cut || slave.slo != 0, delay);
        if (slave.ended != 0) {
            taken = slave.cdm;
        }
        if (slave.stored != 0) {
            stored = (slave.address << 8) | slave.value;
        }
    }

    void step(unsigned clocks)
    {
        while (clocks-- != 0U) {
            step();
        }
    }

    void sample()
    {
        if (place < places) {
            const uint8_t bit = static_cast<uint8_t>(0x80U >> (place % 8U));
            rx[place / 8U] = static_cast<uint8_t>(slo ? rx[place / 8U] | bit : rx[place / 8U] & ~bit);
            place++;
        }
    }

    void samples_into(uint8_t *bytes, size_t size)
    {
        rx = bytes;
        places = 8U * size;
        place = 0;
    }
};

}  // namespace

extern "C" {

Bench *bench_new(int of_spi)
{
    auto bench = std::make_unique<Bench>();
    bench->of_spi = of_spi != 0;
    bench->slave.reset = 1;
    bench->master.reset = 1;
    bench->slave.timeout = 7;  // three halves of a clock period of MA, and one
    bench->step(4);
    bench->slave.reset = 0;
    bench->master.reset = 0;
    bench->step();
    return bench.release();
}

// Between two frames: speed of MA, delay of the line, and time that the slave takes for its data.
void bench_line(Bench *bench, unsigned half, unsigned delay, unsigned processing, int cut)
{
    bench->half = static_cast<uint8_t>(half);
    bench->delay = static_cast<uint8_t>(delay);
    bench->slave.processing = static_cast<uint8_t>(processing);
    bench->slave.timeout = static_cast<uint8_t>(3U * half + 1U);
    bench->cut = cut != 0;
    bench->line.rest();
}

// This many bits, the first in bit 63, and six of CRC follow.
void bench_data(Bench *bench, uint64_t data, unsigned bits)
{
    bench->slave.data = data;
    bench->slave.data_bits = static_cast<uint8_t>(bits);
}

// Disturbances of the bits of this frame, and the time that registers are busy.
void bench_control(Bench *bench, int disturb_cds, int disturb_cdm, unsigned fetch, unsigned store)
{
    bench->slave.disturb_cds = disturb_cds != 0;
    bench->slave.disturb_cdm = disturb_cdm != 0;
    bench->slave.fetch_frames = static_cast<uint16_t>(fetch);
    bench->slave.store_frames = static_cast<uint16_t>(store);
}

int bench_read(Bench *bench, unsigned address)
{
    bench->slave.bank_address = static_cast<uint8_t>(address);
    bench->step();
    return bench->slave.bank_held;
}

void bench_write(Bench *bench, unsigned address, unsigned value)
{
    bench->slave.bank_address = static_cast<uint8_t>(address);
    bench->slave.bank_value = static_cast<uint8_t>(value);
    bench->slave.bank_write = 1;
    bench->step();
    bench->slave.bank_write = 0;
}

// 8 * size clocks of an SPI.
void bench_clocks(Bench *bench, uint8_t *rx, size_t size)
{
    bench->samples_into(rx, size);
    for (size_t at = 0; at < 8U * size; at++) {
        bench->ma = false;
        bench->step(bench->half);
        bench->sample();
        bench->ma = true;
        bench->step(bench->half);
    }
}

// MA at the inverse of CDM for this many clocks, and at rest for as many. Return what was stored, or -1.
int bench_rest(Bench *bench, int cdm, unsigned clocks)
{
    bench->stored = -1;
    bench->ma = cdm == 0;
    bench->step(clocks);
    bench->ma = true;
    bench->step(clocks);
    return bench->stored;
}

// From now on, CDS comes from outside.
void bench_answer(Bench *bench, int cds)
{
    bench->slave.outside = 1;
    bench->slave.outside_cds = cds != 0;
}

// Return the CDM bit that the slave took in the last frame, or -1.
int bench_taken(const Bench *bench)
{
    return bench->taken;
}

void bench_ask(Bench *bench, int late, int write, unsigned first, unsigned count, unsigned busy_limit)
{
    bench->master.late = late != 0;
    bench->master.write = write != 0;
    bench->master.first = static_cast<uint8_t>(first);
    bench->master.count = static_cast<uint8_t>(count);
    bench->master.busy_limit = static_cast<uint16_t>(busy_limit);
    bench->master.ask = 1;
    bench->step();
    bench->master.ask = 0;
}

// Run a frame of the master in Verilog with this many bits of word. Return the state of the access.
int bench_frame(Bench *bench, unsigned bits, uint8_t *data, uint8_t *rx, size_t size)
{
    Vbiss_master &master = bench->master;
    bool framed = false;
    bench->samples_into(rx, size);
    bench->taken = -1;
    master.bits = static_cast<uint8_t>(bits);
    master.most = static_cast<uint8_t>(8U * size);
    master.timeout = static_cast<uint8_t>(20U + bench->delay);
    master.go = 1;
    while (!framed) {
        master.to_write = data[master.done];
        bench->step();
        master.go = 0;
        framed = master.framed != 0;
        if (master.read != 0) {
            data[master.done - 1U] = master.value;
        }
    }
    bench->step();
    return master.outcome;
}

uint64_t bench_read_word(const Bench *bench)
{
    return bench->master.word;
}

int bench_done(const Bench *bench)
{
    return bench->master.done;
}
}
