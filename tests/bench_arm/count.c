/* A plugin for QEMU's user mode: at each of the program's writes to standard output, how many instructions it has executed and how
 * many system calls it has made, as a line on standard error.
 *
 * Debian ships no header for plugins, so what is used of version 1 of their interface is declared here.
 */

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define ARM_WRITE 4

typedef uint64_t plugin_id;
struct qemu_plugin_tb;
struct qemu_info_t;

void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id, void (*)(plugin_id, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *, void (*)(unsigned, void *), int flags, void *);
void qemu_plugin_register_vcpu_syscall_cb(plugin_id, void (*)(plugin_id, unsigned, int64_t, uint64_t, uint64_t, uint64_t, uint64_t,
                                                              uint64_t, uint64_t, uint64_t, uint64_t));
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);

int qemu_plugin_version = 1;

static uint64_t instructions, calls;

static void block_executed(unsigned cpu, void *size)
{
    instructions += (uintptr_t)size;
}

static void block_translated(plugin_id id, struct qemu_plugin_tb *block)
{
    qemu_plugin_register_vcpu_tb_exec_cb(block, block_executed, 0, (void *)(uintptr_t)qemu_plugin_tb_n_insns(block));
}

static void called(plugin_id id, unsigned cpu, int64_t number, uint64_t a1, uint64_t a2, uint64_t a3, uint64_t a4, uint64_t a5,
                   uint64_t a6, uint64_t a7, uint64_t a8)
{
    if (number == ARM_WRITE && a1 == 1)
        fprintf(stderr, "COUNT %llu %llu\n", (unsigned long long)instructions, (unsigned long long)calls);
    calls++;
}

int qemu_plugin_install(plugin_id id, const struct qemu_info_t *info, int argc, char **argv)
{
    qemu_plugin_register_vcpu_tb_trans_cb(id, block_translated);
    qemu_plugin_register_vcpu_syscall_cb(id, called);
    return 0;
}
