/** @file
 * codewheel/result.hpp - results of decoders and usability of positions, for C++17
 *
 * Part of the codewheel runtime. SPDX-License-Identifier: 0BSD
 * This file is yours: use it, change it and pass it on as you like.
 *
 * Each interface's C++17 header uses these types: acme/x1_biss.hpp next to
 * acme/x1_biss.h, for example. All of them work at compile time. They need no library, no
 * exceptions and no allocation.
 */
#ifndef CODEWHEEL_RESULT_HPP
#define CODEWHEEL_RESULT_HPP

#include <stddef.h>
#include <stdint.h>

#include "bits.h"
#include "result.h"

#if (CW_RUNTIME_MAJOR != 1) || (CW_RUNTIME_MINOR != 0)
#error "codewheel/result.hpp 1.0 and version.h differ: take all of codewheel/ from one folder"
#endif
#if !defined(__cplusplus) || (__cplusplus < 201703L)
#error "codewheel/result.hpp needs C++17: compile with -std=c++17 or newer, or include the .h files"
#endif

namespace codewheel {

/** Result of a decoder, an encoder or an access, as in cw_result. */
enum class fault : uint8_t {
    none = CW_OK,                           /**< the frame is well formed */
    length = CW_FAULT_LENGTH,               /**< wrong number of bits or bytes */
    crc = CW_FAULT_CRC,                     /**< the data were corrupted on the line */
    constant = CW_FAULT_CONSTANT,           /**< a fixed bit or a parity bit is wrong */
    range = CW_FAULT_RANGE,                 /**< a value is not in the manual or does not fit */
    transport = CW_FAULT_TRANSPORT,         /**< a transport function failed */
    timeout = CW_FAULT_TIMEOUT,             /**< a poll or a reply took too long */
    unsupported = CW_FAULT_UNSUPPORTED,     /**< a required transport function is missing */
    line_high = CW_FAULT_LINE_HIGH,         /**< data line always high */
    line_low = CW_FAULT_LINE_LOW,           /**< data line low before the frame */
    no_start = CW_FAULT_NO_START,           /**< the acknowledge is longer than the buffer */
    repeat = CW_FAULT_REPEAT,               /**< two readings of the position disagree */
    head_missing = CW_FAULT_HEAD_MISSING,   /**< the first byte of the reply is missing */
    lost = CW_FAULT_LOST,                   /**< the tracker lost the axis */
    verify = CW_FAULT_VERIFY                /**< a register does not hold the value written to it */
};

/** Usability of the position in a valid frame, worst first, as in cw_verdict. */
enum class verdict : uint8_t {
    not_usable = CW_NOT_USABLE,                   /**< wrong, frozen, 0 or doubtful */
    unknown = CW_UNKNOWN,                         /**< the frame has no status bit */
    usable_with_warning = CW_USABLE_WITH_WARNING, /**< usable, but needs attention */
    usable = CW_USABLE                            /**< no error and no warning */
};

/** A value, or the fault that explains why there is none. */
template <typename T>
class [[nodiscard]] result {
public:
    /** Keep the value if a C function returned CW_OK, otherwise keep the result. */
    constexpr result(cw_result returned, const T &value) noexcept
        : value_(value), fault_(static_cast<codewheel::fault>(returned))
    {
    }

    /** Return true if there is a value. */
    constexpr explicit operator bool() const noexcept
    {
        return fault_ == codewheel::fault::none;
    }

    /** Return the fault, or fault::none if there is a value. */
    constexpr codewheel::fault error() const noexcept
    {
        return fault_;
    }

    /** Return the value. Without one, all its members are 0. */
    constexpr const T &operator*() const noexcept
    {
        return value_;
    }

    /** Return a member of the value. Without a value, all its members are 0. */
    constexpr const T *operator->() const noexcept
    {
        return &value_;
    }

private:
    T value_;
    codewheel::fault fault_;
};

/** A position with its verdict. */
template <typename T>
class [[nodiscard]] reading {
public:
    codewheel::verdict verdict; /**< not_usable as well if the frame is not well formed */
    T position;                 /**< the position, or 0 if it is not usable */

    /** Keep the verdict on a well-formed frame, and its position if the position is usable. */
    constexpr reading(codewheel::verdict found, T value) noexcept
        : verdict(found), position((found != codewheel::verdict::not_usable) ? value : T{}),
          fault_(codewheel::fault::none)
    {
    }

    /** Keep the fault of a frame that is not well formed. */
    constexpr reading(codewheel::fault found) noexcept
        : verdict(codewheel::verdict::not_usable), position(), fault_(found)
    {
    }

    /** Return the fault of the frame, or fault::none if it is well formed. */
    constexpr codewheel::fault error() const noexcept
    {
        return fault_;
    }

    /** Return true unless the position is not usable. An unknown verdict counts as usable. */
    constexpr explicit operator bool() const noexcept
    {
        return verdict != codewheel::verdict::not_usable;
    }

private:
    codewheel::fault fault_;
};

/** Return the position of a frame with its verdict. */
template <typename Frame, typename T>
constexpr reading<T> read(const result<Frame> &frame, verdict found, T position) noexcept
{
    return frame ? reading<T>(found, position) : reading<T>(frame.error());
}

/** Bytes of a request or a register. */
template <size_t Size>
struct buffer {
    uint8_t bytes[Size]; /**< in the order sent */

    /** Return the address of the first byte. */
    constexpr const uint8_t *data() const noexcept
    {
        return bytes;
    }

    /** Return the number of bytes. */
    constexpr size_t size() const noexcept
    {
        return Size;
    }
};

/** Bytes that another object holds: an array, a std::array, a std::span or a buffer. */
class view {
public:
    /** View this many bytes. */
    constexpr view(const uint8_t *data, size_t size) noexcept : data_(data), size_(size)
    {
    }

    /** View an array. */
    template <size_t Size>
    constexpr view(const uint8_t (&array)[Size]) noexcept : data_(array), size_(Size)
    {
    }

    /** View an object that has data() and size(). */
    template <typename Bytes, typename = decltype(static_cast<const Bytes *>(nullptr)->data())>
    constexpr view(const Bytes &bytes) noexcept : data_(bytes.data()), size_(bytes.size())
    {
    }

    /** Return the address of the first byte. */
    constexpr const uint8_t *data() const noexcept
    {
        return data_;
    }

    /** Return the number of bytes. */
    constexpr size_t size() const noexcept
    {
        return size_;
    }

private:
    const uint8_t *data_;
    size_t size_;
};

} // namespace codewheel

#endif
