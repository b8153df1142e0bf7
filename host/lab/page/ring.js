/** The latest records of a robot, as columns of numbers. */

const READERS = {
    I: ["getUint32", 4],
    H: ["getUint16", 2],
    B: ["getUint8", 1],
    b: ["getInt8", 1],
    d: ["getFloat64", 8],
    f: ["getFloat32", 4],
};

export class Ring {
    /**
     * @param {{name: string, code: string}[]} channels What a record holds, in its order.
     * @param {number} capacity How many records are kept.
     */
    constructor(channels, capacity) {
        this.capacity = capacity;
        /** @type {Object<string, Float64Array>} The value of each channel in each place. */
        this.columns = {};
        this.readers = channels.map(({ name, code }) => {
            this.columns[name] = new Float64Array(capacity);
            const [method, bytes] = READERS[code];
            return { column: this.columns[name], method, bytes };
        });
        this.bytes = this.readers.reduce((sum, reader) => sum + reader.bytes, 0);
        this.clear();
    }

    /** Forget all records. */
    clear() {
        /** How many records there are. */
        this.length = 0;
        /** The place of the next record; the newest is in the place before. */
        this.next = 0;
    }

    /**
     * Take a record.
     * @param {DataView} view Where it stands, little-endian.
     * @param {number} offset From which byte on.
     */
    push(view, offset) {
        for (const { column, method, bytes } of this.readers) {
            column[this.next] = view[method](offset, true);
            offset += bytes;
        }
        this.next = (this.next + 1) % this.capacity;
        this.length = Math.min(this.length + 1, this.capacity);
    }

    /**
     * The place of a record in the columns.
     * @param {number} age 0 for the newest, 1 for the one before, ...
     * @returns {number}
     */
    place(age) {
        return (this.next - 1 - age + 2 * this.capacity) % this.capacity;
    }

    /**
     * A value of the newest record.
     * @param {string} name A channel.
     * @returns {number} NaN before the first record.
     */
    newest(name) {
        return this.length ? this.columns[name][this.place(0)] : NaN;
    }

    /**
     * A record as an object.
     * @param {number} age 0 for the newest.
     * @returns {Object<string, number> | null}
     */
    record(age = 0) {
        if (age >= this.length) return null;
        const place = this.place(age);
        const entries = Object.entries(this.columns).map(([name, column]) => [name, column[place]]);
        return Object.fromEntries(entries);
    }
}
