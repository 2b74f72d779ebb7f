#define ARG_UNUSED(x) (void)(x)
