/* Stands in for libusb in camera.py: one camera, whose stream comes in real time.
 *
 * What is not here is the real libusb's. As on a host controller, the transfers in flight fill
 * one after the other, each until it is full or a short packet ends it; what comes while none is
 * free is lost. A synchronous read finds what the
 * camera has held back since the last one. The processor time spent in here is told apart.
 */
#define _GNU_SOURCE
#include <libusb-1.0/libusb.h>
#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#define MOST 128

typedef int (*answer_t)(uint8_t, uint8_t, uint16_t, uint16_t, uint8_t *, uint16_t);

static answer_t answer;
static const uint8_t *stream;
static const uint64_t *offsets; /* how much of it has come after so many steps */
static const uint64_t *ends;    /* where short packets end; the last one is beyond all */
static uint64_t step_ns, n_steps, begun_ns, position, lost, longest, entered_ns, used_ns;
static uint64_t transfers;
static struct libusb_transfer *queue[MOST];
static int n_queued, n_cancelled;

static uint64_t read_ns(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return t.tv_sec * 1000000000ull + t.tv_nsec;
}

static uint64_t now_ns(void) { return read_ns(CLOCK_MONOTONIC); }

/* What the thread does from enter to leave is the stand-in's. */
static void enter(void) { entered_ns = read_ns(CLOCK_THREAD_CPUTIME_ID); }
static void leave(void) { used_ns += read_ns(CLOCK_THREAD_CPUTIME_ID) - entered_ns; }

void standin_prepare(answer_t a, const uint8_t *bytes, const uint64_t *of, uint64_t n, uint64_t step,
                     const uint64_t *short_ends)
{
    answer = a, stream = bytes, offsets = of, n_steps = n, step_ns = step, ends = short_ends;
    begun_ns = position = lost = longest = used_ns = transfers = 0;
}

uint64_t standin_begin(void) { return begun_ns = now_ns(); }
uint64_t standin_lost(void) { return lost; }
uint64_t standin_longest(void) { return longest; }
uint64_t standin_used(void) { return used_ns; }
uint64_t standin_transfers(void) { return transfers; }

/* How much has come. */
static uint64_t come(void)
{
    if (!begun_ns)
        return 0;
    uint64_t ns = now_ns() - begun_ns, step = ns / step_ns;
    if (step >= n_steps)
        return offsets[n_steps];
    return offsets[step] + (offsets[step + 1] - offsets[step]) * (ns % step_ns) / step_ns;
}

/* Where a transfer that begins here ends. */
static uint64_t end_of(uint64_t from, uint64_t length)
{
    const uint64_t *end = ends;
    while (*end <= from)
        end++;
    return *end < from + length ? *end : from + length;
}

/* Sleep until so much has come, or until then. */
static void await(uint64_t bytes, uint64_t end_ns)
{
    uint64_t step = begun_ns ? (now_ns() - begun_ns) / step_ns : 0;
    while (begun_ns && step < n_steps && offsets[step + 1] < bytes)
        step++;
    if (begun_ns && step < n_steps) {
        uint64_t part = offsets[step + 1] - offsets[step];
        uint64_t due_ns = begun_ns + step * step_ns;
        if (bytes > offsets[step])
            due_ns += (bytes - offsets[step]) * step_ns / part;
        end_ns = due_ns + 2000 < end_ns ? due_ns + 2000 : end_ns;
    }
    struct timespec t = {end_ns / 1000000000, end_ns % 1000000000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL);
}

/* Fill a buffer. */
static int take(uint8_t *buffer, int length)
{
    uint64_t end = end_of(position, length);
    length = end - position;
    memcpy(buffer, stream + position, length);
    position = end;
    while (*ends <= position)
        ends++;
    return length;
}

static int complete(int status)
{
    struct libusb_transfer *t = queue[0];
    memmove(queue, queue + 1, --n_queued * sizeof *queue);
    t->status = status;
    transfers++;
    t->actual_length = status ? 0 : take(t->buffer, t->length);
    if (t->callback) {
        leave();
        t->callback(t);
        enter();
    }
    return 1;
}

int libusb_handle_events_timeout(libusb_context *c, struct timeval *tv)
{
    enter();
    uint64_t end = now_ns() + tv->tv_sec * 1000000000ull + tv->tv_usec * 1000ull;
    for (int done = 0; !done; ) {
        for (; n_cancelled; n_cancelled--)
            done = complete(LIBUSB_TRANSFER_CANCELLED);
        uint64_t waits = come() - position, full = position;
        int n = n_queued;
        for (int k = 0; k < n; k++)
            full = end_of(full, queue[k]->length);
        if (n && waits > longest)
            longest = waits;
        uint64_t overrun = n && position + waits > full ? position + waits - full : 0;
        while (n-- && come() >= end_of(position, queue[0]->length))
            done = complete(LIBUSB_TRANSFER_COMPLETED);
        if (overrun) /* they took what they could, the rest is gone */
            lost += overrun, position += overrun & ~1ull;
        if (now_ns() >= end)
            break;
        if (!done)
            await(n_queued ? end_of(position, queue[0]->length) : position + 1, end);
    }
    leave();
    return 0;
}

int libusb_submit_transfer(struct libusb_transfer *t)
{
    queue[n_queued++] = t;
    return 0;
}

int libusb_cancel_transfer(struct libusb_transfer *t)
{
    for (int k = 0; k < n_queued; k++)
        if (queue[k] == t)
            return n_cancelled++, 0;
    return LIBUSB_ERROR_NOT_FOUND;
}

int libusb_bulk_transfer(libusb_device_handle *h, unsigned char endpoint, unsigned char *data,
                         int length, int *n, unsigned timeout_ms)
{
    enter();
    uint64_t end = now_ns() + timeout_ms * 1000000ull, waits = come() - position;
    if (waits > longest)
        longest = waits;
    uint64_t full = end_of(position, length);
    while (come() < full && now_ns() < end)
        await(full, end);
    int whole = come() >= full;
    *n = whole ? take(data, length) : 0;
    leave();
    return whole ? 0 : LIBUSB_ERROR_TIMEOUT;
}

int libusb_control_transfer(libusb_device_handle *h, uint8_t type, uint8_t request, uint16_t value,
                            uint16_t index, unsigned char *data, uint16_t length, unsigned timeout)
{
    return answer(type, request, value, index, data, length);
}

/* One device, never really there. */

static libusb_device *const device = (libusb_device *)&answer;

ssize_t libusb_get_device_list(libusb_context *c, libusb_device ***list)
{
    static libusb_device *all[2];
    all[0] = device;
    *list = all;
    return 1;
}

void libusb_free_device_list(libusb_device **list, int unref) {}
libusb_device *libusb_ref_device(libusb_device *d) { return d; }
void libusb_unref_device(libusb_device *d) {}
uint8_t libusb_get_bus_number(libusb_device *d) { return 1; }
uint8_t libusb_get_device_address(libusb_device *d) { return 2; }
uint8_t libusb_get_port_number(libusb_device *d) { return 1; }
int libusb_get_port_numbers(libusb_device *d, uint8_t *p, int n) { return p[0] = 1; }
int libusb_get_device_speed(libusb_device *d) { return LIBUSB_SPEED_SUPER; }
libusb_device *libusb_get_parent(libusb_device *d) { return NULL; }

int libusb_get_device_descriptor(libusb_device *d, struct libusb_device_descriptor *described)
{
    *described = (struct libusb_device_descriptor){
        .bLength = 18, .bDescriptorType = LIBUSB_DT_DEVICE, .bcdUSB = 0x0300,
        .bMaxPacketSize0 = 9, .idVendor = 0x152A, .idProduct = 0x841A, .bcdDevice = 0x0306,
        .bNumConfigurations = 1};
    return 0;
}

int libusb_get_config_descriptor(libusb_device *d, uint8_t number,
                                 struct libusb_config_descriptor **described)
{
    static const struct libusb_endpoint_descriptor endpoint = {
        .bLength = 7, .bDescriptorType = LIBUSB_DT_ENDPOINT, .bEndpointAddress = 0x82,
        .bmAttributes = LIBUSB_TRANSFER_TYPE_BULK, .wMaxPacketSize = 1024};
    static const struct libusb_interface_descriptor setting = {
        .bLength = 9, .bDescriptorType = LIBUSB_DT_INTERFACE, .bNumEndpoints = 1,
        .bInterfaceClass = 0xFF, .endpoint = &endpoint};
    static const struct libusb_interface interface = {&setting, 1};
    static struct libusb_config_descriptor configuration = {
        .bLength = 9, .bDescriptorType = LIBUSB_DT_CONFIG, .wTotalLength = 25,
        .bNumInterfaces = 1, .bConfigurationValue = 1, .interface = &interface};
    *described = &configuration;
    return 0;
}

void libusb_free_config_descriptor(struct libusb_config_descriptor *d) {}

int libusb_open(libusb_device *d, libusb_device_handle **h)
{
    *h = (libusb_device_handle *)&stream;
    return 0;
}

void libusb_close(libusb_device_handle *h) {}
libusb_device *libusb_get_device(libusb_device_handle *h) { return device; }
int libusb_get_configuration(libusb_device_handle *h, int *number) { return *number = 1, 0; }
int libusb_set_configuration(libusb_device_handle *h, int number) { return 0; }
int libusb_claim_interface(libusb_device_handle *h, int number) { return 0; }
int libusb_release_interface(libusb_device_handle *h, int number) { return 0; }
int libusb_clear_halt(libusb_device_handle *h, unsigned char endpoint) { return 0; }
int libusb_kernel_driver_active(libusb_device_handle *h, int number) { return 0; }
