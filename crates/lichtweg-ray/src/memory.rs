//! Large arrays of fixed length on large pages.
//!
//! Rays jump about in tens of megabytes: with 4 kB pages most of these jumps miss the TLB.

use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};
use std::mem::MaybeUninit;
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;

/// Size of a large page on the machines we know.
const LARGE_PAGE: usize = 2 << 20;

/// A fixed array, on large pages where it is large and the system has them.
pub(crate) struct Pages<T: Copy> {
    start: NonNull<T>,
    len: usize,
}

// SAFETY: the array is owned, and borrowed as any slice.
unsafe impl<T: Copy + Send> Send for Pages<T> {}
// SAFETY: as above.
unsafe impl<T: Copy + Sync> Sync for Pages<T> {}

impl<T: Copy> Pages<T> {
    /// An array of `len` elements, all of which `fill` must write.
    ///
    /// # Safety
    /// `fill` must initialise every element.
    pub(crate) unsafe fn filled(len: usize, fill: impl FnOnce(&mut [MaybeUninit<T>])) -> Self {
        let layout = Self::layout(len);
        if layout.size() == 0 {
            fill(&mut []);
            return Self { start: NonNull::dangling(), len: 0 };
        }
        // SAFETY: the size is not zero.
        let start = unsafe { alloc(layout) }.cast::<T>();
        let Some(start) = NonNull::new(start) else { handle_alloc_error(layout) };
        let out = Self { start, len };
        advise_large_pages(start.cast(), layout);
        // SAFETY: freshly allocated for `len` elements; uninitialised memory may be `MaybeUninit`.
        fill(unsafe { std::slice::from_raw_parts_mut(start.cast().as_ptr(), len) });
        out
    }

    fn layout(len: usize) -> Layout {
        let plain = Layout::array::<T>(len).expect("an array fits the address space");
        let align = if plain.size() >= LARGE_PAGE { LARGE_PAGE } else { 64 };
        plain.align_to(align).expect("alignments are powers of two")
    }
}

/// Makes room for `more` elements, on large pages where it is large.
pub(crate) fn reserve<T>(vec: &mut Vec<T>, more: usize) {
    if vec.capacity() - vec.len() >= more {
        return;
    }
    vec.reserve(more);
    let room = vec.spare_capacity_mut();
    let begin = room.as_mut_ptr().cast::<u8>();
    let skipped = begin.align_offset(LARGE_PAGE);
    if let Some(size) = size_of_val(room).checked_sub(skipped).filter(|&size| size >= LARGE_PAGE) {
        let start = NonNull::new(begin.wrapping_add(skipped)).expect("not the null pointer");
        let layout = Layout::from_size_align(size, 1).expect("part of an array");
        advise_large_pages(start, layout);
    }
}

impl<T: Copy> Drop for Pages<T> {
    fn drop(&mut self) {
        let layout = Self::layout(self.len);
        if layout.size() != 0 {
            // SAFETY: allocated in `filled` with this layout.
            unsafe { dealloc(self.start.cast().as_ptr(), layout) };
        }
    }
}

impl<T: Copy> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: `filled` initialised `len` elements.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<T: Copy> DerefMut for Pages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: `filled` initialised `len` elements, and `self` is borrowed for as long as they are.
        unsafe { std::slice::from_raw_parts_mut(self.start.as_ptr(), self.len) }
    }
}

impl<T: Copy> std::fmt::Debug for Pages<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "Pages({})", self.len)
    }
}

#[cfg(all(target_os = "linux", not(miri)))]
fn advise_large_pages(start: NonNull<u8>, layout: Layout) {
    if layout.size() >= LARGE_PAGE {
        // SAFETY: the range was just allocated and starts on a page; this is a hint that changes no
        // content, and a refusal does no harm.
        unsafe { libc::madvise(start.as_ptr().cast(), layout.size(), libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(all(target_os = "linux", not(miri))))]
fn advise_large_pages(_: NonNull<u8>, _: Layout) {}
