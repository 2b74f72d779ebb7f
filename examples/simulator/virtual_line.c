/* Line of a virtual encoder for a simulator: connects to "codewheel simulate ORDER-CODE --tcp PORT" through DPI-C. */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#ifdef __cplusplus
extern "C" { /* Verilator compiles this file as C++. */
#endif
int line_open(int port);
int line_level(int line, int level);
int line_timeout(int line);
#ifdef __cplusplus
}
#endif

/* Send a byte, and return the level of the data line that answers it, or -1. */
static int exchange(int line, char sent)
{
    char level = 0;
    if ((send(line, &sent, 1, 0) != 1) || (recv(line, &level, 1, 0) != 1)) {
        return -1;
    }
    return level - '0';
}

/* Connect to a port of this computer. Return the line, or -1. */
int line_open(int port)
{
    const int on = 1;
    const int line = socket(AF_INET, SOCK_STREAM, 0);
    struct sockaddr_in place;
    memset(&place, 0, sizeof(place));
    place.sin_family = AF_INET;
    place.sin_port = htons((unsigned short)port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if ((line >= 0) && (connect(line, (const struct sockaddr *)&place, sizeof(place)) != 0)) {
        close(line);
        return -1;
    }
    setsockopt(line, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    return line;
}

/* Set the level of the clock. Return the level of the data line, or -1. */
int line_level(int line, int level)
{
    return exchange(line, (level != 0) ? '1' : '0');
}

/* Let the timeout of the encoder pass. Return the level of the data line, or -1. */
int line_timeout(int line)
{
    return exchange(line, 'T');
}
