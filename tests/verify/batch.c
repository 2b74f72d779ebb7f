@headers@
static size_t feed(uint8_t *to, size_t count);
static void emit(const uint8_t *from, size_t count);

static inline void wipe(uint8_t *to, size_t count, uint8_t byte)
{
    size_t index;
    for (index = 0U; index < count; index++) {
        to[index] = byte;
    }
}

static inline void copy(uint8_t *to, const uint8_t *from, size_t count)
{
    size_t index;
    for (index = 0U; index < count; index++) {
        to[index] = from[index];
    }
}

static inline bool is_all(const uint8_t *from, size_t count, uint8_t byte)
{
    size_t index;
    for (index = 0U; index < count; index++) {
        if (from[index] != byte) {
            return false;
        }
    }
    return true;
}

static inline void put(uint8_t *to, uint64_t value, size_t count)
{
    size_t index;
    for (index = 0U; index < count; index++) {
        to[index] = (uint8_t)(value >> (8U * index));
    }
}

static inline uint64_t number(const uint8_t *from, size_t count)
{
    uint64_t value = 0U;
    size_t index;
    for (index = 0U; index < count; index++) {
        value |= (uint64_t)from[index] << (8U * index);
    }
    return value;
}

static inline int64_t to_signed(uint64_t value, uint32_t bits)
{
    const uint64_t half = (UINT64_MAX >> (64U - bits)) >> 1U;
    return value > half ? -(int64_t)((half - (value & half))) - 1 : (int64_t)value;
}

static inline uint64_t word_of(const uint8_t *from)
{
    uint64_t value = 0U;
    size_t index;
    for (index = 1U; index <= 8U; index++) {
        value = (value << 8U) | from[index];
    }
    return value;
}

static inline void put_word(uint8_t *to, uint64_t word)
{
    size_t index;
    for (index = 0U; index < 8U; index++) {
        to[index] = (uint8_t)(word >> (56U - 8U * index));
    }
}
@taken@@codecs@
typedef struct codec {
    void (*decode)(const @prefix@ *variant, const uint8_t *from, uint8_t *to);
    void (*encode)(const @prefix@ *variant, const uint8_t *from, uint8_t *to);
    size_t answer;
    size_t members;
    size_t encoded;
} codec;

static const codec codecs[] = {
@rows@
};

static void set_variant(@prefix@ *variant, const uint8_t *bytes)
{
    wipe((uint8_t *)variant, sizeof *variant, 0U);
    (void)bytes;
@sets@}

static int work(void)
{
    uint8_t head[5];
    uint8_t values[@parameters@];
    uint8_t record[@largest@];
    uint8_t answer[@largest@ + 1];
    @prefix@ variant;
    while (feed(head, sizeof head) == sizeof head && head[0] != 255U) {
        const codec *const chosen = &codecs[number(&head[1], 2U)];
        const bool decode = head[0] == 0U;
        const size_t size = decode ? (size_t)@record@U : chosen->members;
        const size_t length = decode ? chosen->answer : chosen->encoded;
        uint64_t left = number(&head[3], 2U);
        (void)feed(values, @given@U);
        set_variant(&variant, values);
        for (; left > 0U; left--) {
            if (feed(record, size) != size) {
                return 2;
            }
            wipe(answer, sizeof answer, 0U);
            (decode ? chosen->decode : chosen->encode)(&variant, record, &answer[1]);
            emit(answer, length);
        }
    }
    return 0;
}

@entry@
